// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/surface_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "raster/depth_plane.h"

namespace alidade {

namespace {

constexpr int kLevels = 6;  ///< cells of 2 to 64 pixels
/// Cells up to this many levels above the one of the dots' spacing may fill.
constexpr float kLevelSlack = 1.5f;

using MomentImage = Image<Moments>;

class Filler {
 public:
  explicit Filler(DotImage& dots)
      : m_dots(dots), m_width(dots.inverseDepth.width()), m_height(dots.inverseDepth.height()) {}

  void run() {
    MomentImage moments = finest();
    m_filled = Image<float>(m_width, m_height, 0.0f);
    for (int k = 1; k <= kLevels; ++k) {
      if (k > 1) moments = coarser(moments, k);
      parallelFor(static_cast<std::size_t>(moments.height()), 4,
                  [&](std::size_t first, std::size_t last, int) {
                    for (std::size_t y = first; y < last; ++y) {
                      for (int x = 0; x < moments.width(); ++x) fillCell(moments, k, x, static_cast<int>(y));
                    }
                  });
    }
    parallelFor(m_filled.size(), 1 << 16, [&](std::size_t first, std::size_t last, int) {
      float* w = m_dots.inverseDepth.data();
      for (std::size_t i = first; i < last; ++i) w[i] = m_filled.data()[i] > 0.0f ? m_filled.data()[i] : w[i];
    });
  }

 private:
  static int cells(int pixels, int level) { return (pixels + (1 << level) - 1) >> level; }

  MomentImage finest() const {
    MomentImage moments(cells(m_width, 1), cells(m_height, 1));
    parallelFor(static_cast<std::size_t>(moments.height()), 16,
                [&](std::size_t first, std::size_t last, int) {
                  for (auto y = static_cast<int>(2 * first);
                       y < std::min(m_height, static_cast<int>(2 * last)); ++y) {
                    const float* w = m_dots.inverseDepth.row(y);
                    const float* spacing = m_dots.spacingPx.row(y);
                    const std::uint16_t* place = m_dots.place.row(y);
                    Moments* row = moments.row(y >> 1);
                    for (int x = 0; x < m_width; ++x) {
                      if (w[x] <= 0.0f) continue;
                      const float level = spacing[x] > 1.0f ? std::log2(spacing[x]) + 1.0f : 1.0f;
                      const PlaceInPixel in(place[x]);
                      row[x >> 1].addDot((x & 1) - 0.5f + in.u, (y & 1) - 0.5f + in.v, w[x], level);
                    }
                  }
                });
    return moments;
  }

  MomentImage coarser(const MomentImage& fine, int k) const {
    MomentImage moments(cells(m_width, k), cells(m_height, k));
    const float quarter = static_cast<float>(1 << k) / 4.0f;
    parallelFor(static_cast<std::size_t>(moments.height()), 16,
                [&](std::size_t first, std::size_t last, int) {
                  for (auto y = static_cast<int>(2 * first);
                       y < std::min(fine.height(), static_cast<int>(2 * last)); ++y) {
                    for (int x = 0; x < fine.width(); ++x) {
                      moments.at(x >> 1, y >> 1)
                          .add(fine.at(x, y), x & 1 ? quarter : -quarter, y & 1 ? quarter : -quarter);
                    }
                  }
                });
    return moments;
  }

  bool hasGap(int k, int cx, int cy) const {
    const int x1 = std::min((cx + 1) << k, m_width), y1 = std::min((cy + 1) << k, m_height);
    for (int y = cy << k; y < y1; ++y) {
      for (int x = cx << k; x < x1; ++x) {
        if (m_filled.at(x, y) <= 0.0f) return true;
      }
    }
    return false;
  }

  static Moments cellAt(const MomentImage& moments, int x, int y) {
    return moments.contains(x, y) ? moments.at(x, y) : Moments{};
  }

  /// The 3×3 cells, else the best quarter of them (after Kuwahara 1976), about the middle one.
  static Plane planeAround(const std::array<std::array<Moments, 3>, 3>& cell, float size) {
    Moments all;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) all.add(cell[j][i], (i - 1) * size, (j - 1) * size);
    }
    const Plane whole = fit(all);
    if (whole.good || cell[1][1].n == 0) return whole;
    Plane best;
    float most = 0;
    for (int q = 0; q < 4; ++q) {
      Moments quarter;
      const int i0 = q & 1, j0 = q >> 1;
      for (int j = j0; j < j0 + 2; ++j) {
        for (int i = i0; i < i0 + 2; ++i) quarter.add(cell[j][i], (i - 1) * size, (j - 1) * size);
      }
      const Plane plane = fit(quarter);
      if (!plane.good || quarter.n <= most) continue;
      best = plane;
      most = quarter.n;
    }
    return best;
  }

  void fillCell(const MomentImage& moments, int k, int cx, int cy) {
    std::array<std::array<Moments, 3>, 3> cell;
    float n = 0, level = 0;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        cell[j][i] = cellAt(moments, cx + i - 1, cy + j - 1);
        n += cell[j][i].n;
        level += cell[j][i].level;
      }
    }
    if (n < 4 || level / n + kLevelSlack < static_cast<float>(k)) return;
    // Dots on all four sides, or the picture's border: a silhouette is not guessed outwards.
    const auto holds = [&](int i, int j) {
      return cell[1 + j][1 + i].n > 0 || !moments.contains(cx + i, cy + j);
    };
    const bool enclosed = holds(-1, 0) && holds(1, 0) && holds(0, -1) && holds(0, 1);
    if (!enclosed) return;
    if (!hasGap(k, cx, cy)) return;
    const auto size = static_cast<float>(1 << k);
    const Plane plane = planeAround(cell, size);
    if (plane.good) fillPixels(plane, k, cx, cy);
  }

  void fillPixels(const Plane& plane, int k, int cx, int cy) {
    const int x0 = cx << k, y0 = cy << k;
    const float middle = 0.5f * static_cast<float>((1 << k) - 1);
    for (int y = y0; y < std::min(y0 + (1 << k), m_height); ++y) {
      for (int x = x0; x < std::min(x0 + (1 << k), m_width); ++x) {
        if (m_filled.at(x, y) > 0.0f) continue;
        float w = plane.w0 + plane.gx * (static_cast<float>(x - x0) - middle) +
                  plane.gy * (static_cast<float>(y - y0) - middle);
        if (const float dot = m_dots.inverseDepth.at(x, y); dot > 0.0f) {
          const PlaceInPixel in(m_dots.place.at(x, y));
          const float slope = plane.gx * in.u + plane.gy * in.v;
          if (std::abs(dot - slope - w) > 3.0f * allowedResidual(w)) continue;
          w = dot - slope;
        }
        m_filled.at(x, y) = std::max(w, 0.0f);
      }
    }
  }

  DotImage& m_dots;
  int m_width, m_height;
  Image<float> m_filled;
};

}  // namespace

void fillBetweenDots(DotImage& dots) {
  Filler(dots).run();
}

}  // namespace alidade
