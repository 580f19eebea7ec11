// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/eye_dome.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr float kScale = 300.0f;
constexpr std::size_t kRows = 16;

/// log2 of a positive normal float within 1e-6 of its value near 1 and 2e-7 absolute elsewhere: exponent, then
/// the series of the inverse hyperbolic tangent about the middle of [0.7, 1.4]. No branch, so that loops over it
/// turn into vector code.
[[gnu::always_inline]] inline float logarithm2(float value) {
  const auto bits = std::bit_cast<std::int32_t>(value);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(bits - (exponent << 23));
  const float t = (m - 1.0f) / (m + 1.0f), t2 = t * t;
  // 2 / ln 2 · (1, 1/3, 1/5, 1/7, 1/9)
  const float series =
      2.8853901f + t2 * (0.96179669f + t2 * (0.57707802f + t2 * (0.41219858f + t2 * 0.32059890f)));
  return static_cast<float>(exponent) + t * series;
}

/// exp(-x) for x >= 0: a Taylor series of degree 5 of x / 32, squared five times; within 2e-5.
[[gnu::always_inline]] inline float negativeExponential(float x) {
  const float s = std::min(x, 32.0f) * (-1.0f / 32.0f);
  float e = 1 + s * (1 + s * (0.5f + s * (1.0f / 6 + s * (1.0f / 24 + s * (1.0f / 120)))));
  for (int i = 0; i < 5; ++i) e *= e;
  return e;
}

#if defined(__x86_64__)
#define ALIDADE_CLONES [[gnu::target_clones("avx512f", "avx2", "default")]]
#else
#define ALIDADE_CLONES
#endif

ALIDADE_CLONES void logarithmRow(const float* z, int width, float* logs) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (int x = 0; x < width; ++x) {
    const bool isKnown = z[x] > 0.0f && z[x] < std::numeric_limits<float>::max();
    const float value = logarithm2(isKnown ? z[x] : 1.0f);
    logs[x] = isKnown ? value : kInf;
  }
}

/// Rows of logarithms about the one that is shaded.
struct Ring {
  const float *here, *up, *down, *upper, *lower;
  int radius, diagonal;
};

ALIDADE_CLONES void shadeRow(const Ring& ring, float scale, int width, float* shade) {
  const float *here = ring.here, *up = ring.up, *down = ring.down;
  const float *left = here - ring.radius, *right = here + ring.radius;
  const float *upperLeft = ring.upper - ring.diagonal, *upperRight = ring.upper + ring.diagonal;
  const float *lowerLeft = ring.lower - ring.diagonal, *lowerRight = ring.lower + ring.diagonal;
  for (int x = 0; x < width; ++x) {
    const float own = here[x];
    float sum = 0;
    for (const float* other : {left, right, up, down, upperLeft, upperRight, lowerLeft, lowerRight}) {
      const float step = own - other[x];
      sum += step > 0.0f ? step : 0.0f;
    }
    const float dark = negativeExponential(scale * sum);
    shade[x] = own < std::numeric_limits<float>::infinity() ? dark : 1.0f;
  }
}

/// log2 z in a border of `radius` empty pixels; +inf where nothing is, which shades nobody.
Image<float> logarithms(const DepthImage& depth, int radius) {
  Image<float> logs(depth.width() + 2 * radius, depth.height() + 2 * radius,
                    std::numeric_limits<float>::infinity());
  parallelFor(static_cast<std::size_t>(depth.height()), kRows, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      logarithmRow(depth.row(y), depth.width(), logs.row(y + radius) + radius);
    }
  });
  return logs;
}

/// Calls use(y, shades of the row).
template <class Use>
void shadeRows(const DepthImage& depth, const EyeDomeOptions& options, const Use& use) {
  const int radius = std::clamp(options.radiusPx, 1, 64), width = depth.width();
  const int diagonal = std::max(1, static_cast<int>(std::lround(radius * 0.70710678)));
  const auto scale = static_cast<float>(kScale * std::max(0.0, options.strength) / 8.0);
  const Image<float> logs = logarithms(depth, radius);
  parallelFor(static_cast<std::size_t>(depth.height()), kRows, [&](std::size_t first, std::size_t last, int) {
    std::vector<float> shade(static_cast<std::size_t>(width));
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      const auto at = [&](int down) { return logs.row(y + radius + down) + radius; };
      const Ring ring{at(0), at(-radius), at(radius), at(-diagonal), at(diagonal), radius, diagonal};
      shadeRow(ring, scale, width, shade.data());
      use(y, shade.data());
    }
  });
}

}  // namespace

Image<float> eyeDomeShade(const DepthImage& depth, const EyeDomeOptions& options) {
  Image<float> shade(depth.width(), depth.height(), Uncleared{});
  shadeRows(depth, options,
            [&](int y, const float* row) { std::copy_n(row, depth.width(), shade.row(y)); });
  return shade;
}

void applyEyeDome(const DepthImage& depth, const EyeDomeOptions& options, ColourImage& colour) {
  assert(colour.width() == depth.width() && colour.height() == depth.height());
  shadeRows(depth, options, [&](int y, const float* shade) {
    Rgba8* row = colour.row(y);
    for (int x = 0; x < depth.width(); ++x) {
      const auto factor = static_cast<std::uint32_t>(256.0f * shade[x] + 0.5f);
      row[x].r = static_cast<std::uint8_t>(row[x].r * factor >> 8);
      row[x].g = static_cast<std::uint8_t>(row[x].g * factor >> 8);
      row[x].b = static_cast<std::uint8_t>(row[x].b * factor >> 8);
    }
  });
}

}  // namespace alidade
