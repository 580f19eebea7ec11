// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/surface_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "raster/depth_plane.h"
#include "raster/front_peeler.h"

namespace alidade {

namespace {

constexpr int kLevels = 6;  ///< cells of 2 to 64 pixels
/// Cells up to this many levels above the one of the dots' spacing may fill.
constexpr float kLevelSlack = 1.5f;
/// The same for a surface that fills what its dots enclose, and how far below; its cells' levels; and how
/// many surfaces of a block may fill.
constexpr float kEnclosedSlack = 1.5f, kEnclosedFiner = 0.5f;
constexpr int kFinestEnclosed = 2, kCoarsestEnclosed = 5;
constexpr int kSurfaces = 3;
/// A tight plane over cells of so many levels comes first: it evens out the noise of grazing surfaces.
constexpr int kSmoothLevel = 3;
constexpr float kSmoothDots = 9;

using MomentImage = Image<Moments>;

class Filler {
 public:
  explicit Filler(DotImage& dots)
      : m_dots(dots), m_width(dots.inverseDepth.width()), m_height(dots.inverseDepth.height()) {}

  void run() {
    std::vector<MomentImage> pyramid{finest()};
    for (int k = 2; k <= kLevels; ++k) pyramid.push_back(coarser(pyramid.back(), k));
    m_filled = Image<float>(m_width, m_height, 0.0f);
    for (int k = kSmoothLevel; k >= 2; --k) fillLevel(pyramid[k - 1], k, true);
    for (int k = 1; k <= kLevels; ++k) fillLevel(pyramid[k - 1], k, false);
    fillEdges(pyramid);
    parallelFor(m_filled.size(), 1 << 16, [&](std::size_t first, std::size_t last, int) {
      float* w = m_dots.inverseDepth.data();
      for (std::size_t i = first; i < last; ++i) w[i] = m_filled.data()[i] > 0.0f ? m_filled.data()[i] : w[i];
    });
  }

 private:
  /// Near edges, where cells around are not all of one surface.
  void fillEdges(const std::vector<MomentImage>& pyramid) {
    for (int k = kFinestEnclosed; k <= kCoarsestEnclosed; ++k) {
      const MomentImage& level = pyramid[k - 1];
      parallelFor(static_cast<std::size_t>(level.height()), 4, [&](std::size_t first, std::size_t last, int) {
        FrontPeeler peeler;
        for (std::size_t y = first; y < last; ++y) {
          for (int x = 0; x < level.width(); ++x) fillEnclosed(level, k, x, static_cast<int>(y), peeler);
        }
      });
    }
  }

  /// `smooth`: only where the plane is as tight as the scan's noise.
  void fillLevel(const MomentImage& moments, int k, bool smooth) {
    parallelFor(static_cast<std::size_t>(moments.height()), 4, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t y = first; y < last; ++y) {
        for (int x = 0; x < moments.width(); ++x) fillCell(moments, k, x, static_cast<int>(y), smooth);
      }
    });
  }

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

  static bool isTight(const Plane& plane) {
    const float tight = surfaceTightness(plane.w0, plane);
    return plane.variance <= tight * tight;
  }

  static Plane wholePlane(const std::array<std::array<Moments, 3>, 3>& cell, float size) {
    Moments all;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) all.add(cell[j][i], (i - 1) * size, (j - 1) * size);
    }
    return fit(all);
  }

  /// The 3×3 cells, else the best quarter of them (after Kuwahara 1976), about the middle one.
  static Plane planeAround(const std::array<std::array<Moments, 3>, 3>& cell, float size) {
    const Plane whole = wholePlane(cell, size);
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

  void fillCell(const MomentImage& moments, int k, int cx, int cy, bool smooth) {
    float n = 0, level = 0;
    for (int y = cy - 1; y <= cy + 1; ++y) {
      for (int x = cx - 1; x <= cx + 1; ++x) {
        if (!moments.contains(x, y)) continue;
        n += moments.at(x, y).n;
        level += moments.at(x, y).level;
      }
    }
    if (n < (smooth ? kSmoothDots : 4.0f) || level / n + kLevelSlack < static_cast<float>(k)) return;
    // Dots on all four sides, or the picture's border: a silhouette is not guessed outwards.
    const auto holds = [&](int x, int y) { return !moments.contains(x, y) || moments.at(x, y).n > 0; };
    if (!holds(cx - 1, cy) || !holds(cx + 1, cy) || !holds(cx, cy - 1) || !holds(cx, cy + 1)) return;
    if (!hasGap(k, cx, cy)) return;
    std::array<std::array<Moments, 3>, 3> cell;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) cell[j][i] = cellAt(moments, cx + i - 1, cy + j - 1);
    }
    const auto size = static_cast<float>(1 << k);
    if (smooth) {
      const Plane plane = wholePlane(cell, size);
      if (plane.good && isTight(plane))
        fillPixels(
            k, cx, cy, [&](float, float) { return plane; }, true);
      return;
    }
    const Plane plane = planeAround(cell, size);
    if (plane.good) fillPixels(k, cx, cy, [&](float, float) { return plane; });
  }

  /// Takes the plane for each pixel from planeAt(x, y), pixels from the cell's middle; none where it is not
  /// good.
  template <class PlaneAt>
  void fillPixels(int k, int cx, int cy, const PlaneAt& planeAt, bool smooth = false) {
    const int x0 = cx << k, y0 = cy << k;
    const float middle = 0.5f * static_cast<float>((1 << k) - 1);
    for (int y = y0; y < std::min(y0 + (1 << k), m_height); ++y) {
      for (int x = x0; x < std::min(x0 + (1 << k), m_width); ++x) {
        if (m_filled.at(x, y) > 0.0f) continue;
        const float inX = static_cast<float>(x - x0) - middle, inY = static_cast<float>(y - y0) - middle;
        const Plane plane = planeAt(inX, inY);
        if (plane.good) fillPixel(plane.w0 + plane.gx * inX + plane.gy * inY, plane, x, y, smooth);
      }
    }
  }

  /// With the plane's inverse depth `w` there; a dot keeps its own, moved along the plane.
  void fillPixel(float w, const Plane& plane, int x, int y, bool smooth) {
    if (const float dot = m_dots.inverseDepth.at(x, y); dot > 0.0f) {
      const PlaceInPixel in(m_dots.place.at(x, y));
      const float moved = dot - plane.gx * in.u - plane.gy * in.v;
      if (std::abs(moved - w) > 3.0f * (smooth ? surfaceTightness(w, plane) : allowedResidual(w))) return;
      const float tight = surfaceTightness(w, plane);
      const bool isTight = plane.variance <= tight * tight && std::abs(moved - w) <= 3.0f * tight;
      if (!isTight) w = moved;
    }
    m_filled.at(x, y) = std::max(w, 0.0f);
  }

  /// Where the cells around are not all of one surface: each surface in turn, nearest first, fills the pixels
  /// that its own dots enclose.
  void fillEnclosed(const MomentImage& moments, int k, int cx, int cy, FrontPeeler& peeler) {
    float n = 0, level = 0;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        if (!moments.contains(cx + i, cy + j)) continue;
        n += moments.at(cx + i, cy + j).n;
        level += moments.at(cx + i, cy + j).level;
      }
    }
    if (n < 6 || static_cast<float>(k) > level / n + kEnclosedSlack ||
        static_cast<float>(k) < level / n - kEnclosedFiner)
      return;
    if (!hasGap(k, cx, cy)) return;
    peeler.gather(m_dots, k, cx, cy);
    for (int surface = 0; surface < kSurfaces && peeler.findSurface(); ++surface) {
      fillPixels(k, cx, cy, [&](float x, float y) {
        return peeler.encloses(x, y) && peeler.isNearest(x, y) ? peeler.plane() : Plane();
      });
      if (!hasGap(k, cx, cy)) return;
      peeler.dropSurface();
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
