// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "raster/surface_fill.h"

namespace alidade {

namespace {

constexpr int kLevels = 6;               ///< cells of 2 to 64 pixels
constexpr int kBandRows = 1 << kLevels;  ///< whole cells of every level
/// How much nearer a wall must be, as a part of the depth: above the noise and slope within a cell.
constexpr float kGap = 0.01f;

/// Cells of a level, with a border of one empty cell, so that neighbours need no checks.
class CellImage {
 public:
  CellImage() = default;
  CellImage(int width, int height) : m_cells(width + 2, height + 2, 0.0f) {}
  float* row(int y) { return m_cells.row(y + 1) + 1; }
  const float* row(int y) const { return m_cells.row(y + 1) + 1; }

 private:
  Image<float> m_cells;
};

int levelOf(float spacingPx) {
  // Also right for spacings of 0.
  int level = 1;
  for (float cell = 1.0f; cell < spacingPx && level < kLevels; cell *= 2.0f) ++level;
  return level;
}

/// The nearest dots a cell, then the walls around it. w is inverse depth: larger is nearer. A dot counts at
/// the one level of its surface's spacing: at coarser ones a thin post would grow into a wall.
class WallPyramid {
 public:
  WallPyramid(int width, int height) : m_width(width), m_height(height) {
    for (int k = 1; k <= kLevels; ++k) {
      m_nearest[k] = CellImage(cells(width, k), cells(height, k));
      m_wall[k] = CellImage(cells(width, k), cells(height, k));
    }
  }

  void build(const DotImage& dots) {
    const auto bands = static_cast<std::size_t>((m_height + kBandRows - 1) / kBandRows);
    parallelFor(bands, 1, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t band = first; band < last; ++band) gather(dots, static_cast<int>(band) * kBandRows);
    });
    for (int k = kLevels; k >= 1; --k) {
      parallelFor(static_cast<std::size_t>(cells(m_height, k)), 16,
                  [&](std::size_t first, std::size_t last, int) {
                    for (std::size_t y = first; y < last; ++y) wallRow(k, static_cast<int>(y));
                  });
    }
  }

  /// The inverse depth of the wall before pixel (x, y); 0 where there is none.
  const float* wallRowAbove(int y) const { return m_wall[1].row(y >> 1); }

 private:
  static int cells(int pixels, int level) { return (pixels + (1 << level) - 1) >> level; }

  void gather(const DotImage& dots, int top) {
    const int bottom = std::min(top + kBandRows, m_height);
    for (int y = top; y < bottom; ++y) {
      const float* w = dots.inverseDepth.row(y);
      const float* spacing = dots.spacingPx.row(y);
      for (int x = 0; x < m_width; ++x) {
        if (w[x] <= 0.0f) continue;
        const int k = levelOf(spacing[x]);
        float& cell = m_nearest[k].row(y >> k)[x >> k];
        cell = std::max(cell, w[x]);
      }
    }
  }

  void wallRow(int k, int y) {
    const float* above = m_nearest[k].row(y - 1);
    const float* here = m_nearest[k].row(y);
    const float* below = m_nearest[k].row(y + 1);
    const float* coarser = k < kLevels ? m_wall[k + 1].row(y >> 1) : nullptr;
    float* wall = m_wall[k].row(y);
    for (int x = 0; x < cells(m_width, k); ++x) {
      const float a = std::min(here[x - 1], here[x + 1]), b = std::min(above[x], below[x]);
      const float c = std::min(above[x - 1], below[x + 1]), d = std::min(above[x + 1], below[x - 1]);
      // The third largest of four.
      const float third =
          std::max(std::min(std::max(a, b), std::min(c, d)), std::min(std::min(a, b), std::max(c, d)));
      wall[x] = coarser ? std::max(third, coarser[x >> 1]) : third;
    }
  }

  int m_width, m_height;
  std::array<CellImage, kLevels + 1> m_nearest, m_wall;
};

}  // namespace

void removeHiddenDots(DotImage& dots) {
  const int width = dots.inverseDepth.width(), height = dots.inverseDepth.height();
  WallPyramid pyramid(width, height);
  pyramid.build(dots);
  parallelFor(static_cast<std::size_t>(height), 32, [&](std::size_t first, std::size_t last, int) {
    for (auto y = static_cast<int>(first); y < static_cast<int>(last); ++y) {
      float* w = dots.inverseDepth.row(y);
      const float* wall = pyramid.wallRowAbove(y);
      for (int x = 0; x < width; ++x) {
        if (wall[x >> 1] > w[x] * (1.0f + kGap)) w[x] = 0.0f;
      }
    }
  });
}

}  // namespace alidade
