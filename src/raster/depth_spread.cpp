// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/depth_spread.h"

#include <algorithm>
#include <vector>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr float kOneSurface = 0.03f;

/// A full pixel lies a quarter of a half one from the middle of its own: 9/16 of it, 3/16 of each neighbour on its side
/// and 1/16 of the one across. Comparisons with NaN are false, so that one leaves the own depth.
inline float between(float own, float beside, float above, float across) {
  const float low = std::min(std::min(own, beside), std::min(above, across));
  const float high = std::max(std::max(own, beside), std::max(above, across));
  const float mixed = 0.5625f * own + 0.1875f * (beside + above) + 0.0625f * across;
  // A sum with NaN or infinity is no number, whatever min and max made of it.
  return (high - low < kOneSurface * own) & (mixed < 2 * own) ? mixed : own;
}

}  // namespace

DepthImage spreadDepth(const DepthImage& half) {
  const int width = half.width(), height = half.height();
  DepthImage full(2 * width, 2 * height, Uncleared{});
  parallelFor(static_cast<std::size_t>(height), 16, [&](std::size_t first, std::size_t last, int) {
    // A border of one pixel on each side spares the checks.
    std::vector<float> rows(3 * static_cast<std::size_t>(width + 2)), left(static_cast<std::size_t>(width)), right(left);
    float* const row[3] = {rows.data(), rows.data() + width + 2, rows.data() + 2 * (width + 2)};
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      for (int k = 0; k < 3; ++k) {
        const float* from = half.row(std::clamp(y + k - 1, 0, height - 1));
        std::copy(from, from + width, row[k] + 1);
        row[k][0] = from[0];
        row[k][width + 1] = from[width - 1];
      }
      for (int side = 0; side < 2; ++side) {
        const float* const own = row[1] + 1;
        const float* const other = row[2 * side] + 1;
        for (int x = 0; x < width; ++x) left[static_cast<std::size_t>(x)] = between(own[x], own[x - 1], other[x], other[x - 1]);
        for (int x = 0; x < width; ++x) right[static_cast<std::size_t>(x)] = between(own[x], own[x + 1], other[x], other[x + 1]);
        float* out = full.row(2 * y + side);
        for (int x = 0; x < width; ++x) {
          out[2 * x] = left[static_cast<std::size_t>(x)];
          out[2 * x + 1] = right[static_cast<std::size_t>(x)];
        }
      }
    }
  });
  return full;
}

}  // namespace alidade
