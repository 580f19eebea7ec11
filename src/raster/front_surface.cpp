// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "raster/depth_plane.h"
#include "raster/front_peeler.h"
#include "raster/surface_fill.h"

namespace alidade {

namespace {

constexpr int kFinest = 2, kCoarsest = 5;  ///< cells of 4 to 32 pixels
/// How far a cell's level may lie from that of its dots' own spacing.
constexpr float kFiner = 0.5f, kCoarser = 2.5f;
constexpr float kLeastDots = 7;
constexpr float kBimodal =
    4.0f;  ///< variance of a block, in that of a tight surface, above which it holds two
/// A surface hides only where it covers the block: poles in a row are no wall.
constexpr int kLeastCells = 8;

class FrontSurfaces {
 public:
  explicit FrontSurfaces(DotImage& dots)
      : m_dots(dots), m_width(dots.inverseDepth.width()), m_height(dots.inverseDepth.height()) {}

  void run() {
    Image<Moments> moments = finest();
    for (int k = kFinest; k <= kCoarsest; ++k) {
      if (k > kFinest) moments = coarser(moments, k);
      m_hidden = Image<std::uint8_t>(m_width, m_height, 0);
      parallelFor(static_cast<std::size_t>(moments.height()), 4,
                  [&](std::size_t first, std::size_t last, int) {
                    FrontPeeler peeler;
                    for (std::size_t y = first; y < last; ++y)
                      for (int x = 0; x < moments.width(); ++x)
                        peelCell(moments, k, x, static_cast<int>(y), peeler);
                  });
      parallelFor(m_hidden.size(), 1 << 16, [&](std::size_t first, std::size_t last, int) {
        for (std::size_t i = first; i < last; ++i)
          if (m_hidden.data()[i]) m_dots.inverseDepth.data()[i] = 0.0f;
      });
    }
  }

 private:
  static int cells(int pixels, int level) { return (pixels + (1 << level) - 1) >> level; }

  Image<Moments> finest() const {
    constexpr int size = 1 << kFinest;
    Image<Moments> moments(cells(m_width, kFinest), cells(m_height, kFinest));
    parallelFor(static_cast<std::size_t>(moments.height()), 8, [&](std::size_t first, std::size_t last, int) {
      for (int y = static_cast<int>(first) * size; y < std::min(m_height, static_cast<int>(last) * size);
           ++y) {
        for (int x = 0; x < m_width; ++x) {
          const float w = m_dots.inverseDepth.at(x, y);
          if (w <= 0.0f) continue;
          const float spacing = m_dots.spacingPx.at(x, y);
          const PlaceInPixel in(m_dots.place.at(x, y));
          moments.at(x >> kFinest, y >> kFinest)
              .addDot((x & (size - 1)) - 0.5f * (size - 1) + in.u,
                      (y & (size - 1)) - 0.5f * (size - 1) + in.v, w,
                      spacing > 1.0f ? std::log2(spacing) + 1.0f : 1.0f);
        }
      }
    });
    return moments;
  }

  static Image<Moments> coarser(const Image<Moments>& fine, int k) {
    Image<Moments> moments((fine.width() + 1) / 2, (fine.height() + 1) / 2);
    const float quarter = static_cast<float>(1 << k) / 4.0f;
    for (int y = 0; y < fine.height(); ++y)
      for (int x = 0; x < fine.width(); ++x)
        moments.at(x >> 1, y >> 1).add(fine.at(x, y), x & 1 ? quarter : -quarter, y & 1 ? quarter : -quarter);
    return moments;
  }

  void peelCell(const Image<Moments>& moments, int k, int cx, int cy, FrontPeeler& peeler) {
    if (moments.at(cx, cy).n == 0) return;
    const auto size = static_cast<float>(1 << k);
    Moments all;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        if (moments.contains(cx + i, cy + j)) all.add(moments.at(cx + i, cy + j), i * size, j * size);
      }
    }
    if (all.n < kLeastDots) return;
    const float level = all.level / all.n;
    if (static_cast<float>(k) < level - kFiner || static_cast<float>(k) > level + kCoarser) return;
    const Plane whole = fit(all);
    const float tight = surfaceTightness(all.w / all.n, whole);
    if (whole.w0 > 0.0f && whole.variance <= kBimodal * tight * tight) return;
    peeler.gather(m_dots, k, cx, cy);
    if (peeler.findSurface() && peeler.occupiedCells() >= kLeastCells) hideBehind(peeler, k, cx, cy);
  }

  void hideBehind(const FrontPeeler& front, int k, int cx, int cy) {
    const float middle = 0.5f * static_cast<float>((1 << k) - 1);
    const int x0 = cx << k, y0 = cy << k;
    for (int y = y0; y < std::min((cy + 1) << k, m_height); ++y) {
      for (int x = x0; x < std::min((cx + 1) << k, m_width); ++x) {
        const float dot = m_dots.inverseDepth.at(x, y);
        if (dot <= 0.0f) continue;
        const float inX = static_cast<float>(x - x0) - middle, inY = static_cast<float>(y - y0) - middle;
        const float plane = front.at(inX, inY);
        if (dot >= plane - kBehindSurface * surfaceTightness(plane, front.plane())) continue;
        if (front.encloses(inX, inY)) m_hidden.at(x, y) = 1;
      }
    }
  }

  DotImage& m_dots;
  int m_width, m_height;
  Image<std::uint8_t> m_hidden;
};

}  // namespace

void peelToFront(DotImage& dots) {
  FrontSurfaces(dots).run();
}

}  // namespace alidade
