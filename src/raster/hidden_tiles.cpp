// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/hidden_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr int kSize = HiddenTiles::kSize;
constexpr std::size_t kTileRowsAtATime = 16;
/// Boxes that are larger on screen are never hidden as a whole, and a lens would bend their edges far out of their corners.
constexpr double kLargestPx = 600.0;

}  // namespace

HiddenTiles::HiddenTiles(int width, int height)
    : m_columns((width + kSize - 1) / kSize), m_rows((height + kSize - 1) / kSize),
      m_own(static_cast<std::size_t>(m_columns) * m_rows), m_farthest(m_own.size()) {}

void HiddenTiles::look(const LevelSurface& surface) {
  constexpr int kCells = kSize / 2;
  const int columns = surface.columns - 2 * SplatLevels::kMargin, rows = surface.inverse.height() - 2 * SplatLevels::kMargin;
  parallelFor(static_cast<std::size_t>(m_rows), kTileRowsAtATime, [&](std::size_t first, std::size_t last, int) {
    std::vector<float> least(static_cast<std::size_t>(m_columns) * kCells);
    for (auto tile = static_cast<int>(first); tile < static_cast<int>(last); ++tile) {
      std::ranges::fill(least, std::numeric_limits<float>::infinity());
      for (int y = tile * kCells; y < std::min((tile + 1) * kCells, rows); ++y) {
        const float* row = surface.inverse.row(y + SplatLevels::kMargin) + SplatLevels::kMargin;
        for (int x = 0; x < columns; ++x) least[static_cast<std::size_t>(x)] = std::min(least[static_cast<std::size_t>(x)], row[x]);
      }
      for (int x = 0; x < m_columns; ++x)
        m_own[static_cast<std::size_t>(tile * m_columns + x)] = 1.0f / *std::min_element(least.begin() + x * kCells, least.begin() + (x + 1) * kCells);
    }
  });
  for (int y = 0; y < m_rows; ++y) {
    for (int x = 0; x < m_columns; ++x) {
      float farthest = 0;
      for (int j = std::max(0, y - 1); j <= std::min(m_rows - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(m_columns - 1, x + 1); ++i) farthest = std::max(farthest, m_own[static_cast<std::size_t>(j * m_columns + i)]);
      m_farthest[static_cast<std::size_t>(y * m_columns + x)] = farthest;
    }
  }
}

bool HiddenTiles::hides(const SplatRun& run) const {
  const Camera& camera = *static_cast<const Camera*>(run.view.camera);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 sides((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    const glm::dvec3 corner = run.boxMiddle + run.boxHalf * sides;
    if (!(corner.z > 0)) return false;
    const auto pixel = camera.project(corner);
    if (!pixel) return false;
    low = glm::min(low, *pixel);
    high = glm::max(high, *pixel);
  }
  const double reach = glm::length(high - low);
  if (!(reach < kLargestPx)) return false;
  // A straight edge bends by no more than that of a circle as wide as the focal length.
  const double bulge = reach * reach / (8.0 * std::min(std::abs(camera.intrinsics().fx), std::abs(camera.intrinsics().fy)));
  // A cell is less than twice as wide as its points want it.
  const double size = 2.0 * std::clamp<double>(run.view.sizeTimesDepth / run.nearest, run.view.smallest, run.view.largest);
  const double margin = std::max(0.0, bulge + size - kSize);  // the tiles around a tile are looked at in any case
  const auto tileOf = [](double pixel, int count) { return static_cast<int>(std::clamp(std::floor((pixel + 0.5) / kSize), 0.0, count - 1.0)); };
  const int left = tileOf(low.x - margin, m_columns), right = tileOf(high.x + margin, m_columns);
  const int top = tileOf(low.y - margin, m_rows), bottom = tileOf(high.y + margin, m_rows);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x)
      if (!(m_farthest[static_cast<std::size_t>(y * m_columns + x)] < 0.9 * run.nearest)) return false;
  return true;
}

}  // namespace alidade
