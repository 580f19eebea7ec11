// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <vector>

#include "raster/depth_plane.h"
#include "raster/surface_fill.h"

namespace alidade {

/// A dot of a block of cells: pixels from the middle of the block, inverse depth.
struct BlockDot {
  float x, y, w;
};

inline constexpr float kTightPixels = 0.1f;
/// How far a dot of a tight surface lies from its plane, in inverse depth: the scan's noise, not the
/// thickness of a wall. Noise across the line of sight, a fraction of a pixel, moves a dot of a grazing
/// surface far along it.
inline float surfaceTightness(float w, const Plane& plane) {
  return w * (0.0005f + 0.008f * w) + kTightPixels * (std::abs(plane.gx) + std::abs(plane.gy));
}
/// What lies so many times as far behind a surface is not of it.
inline constexpr float kBehindSurface = 4.0f;

/// The nearest surface of a block, found by dropping whatever lies behind the mean plane again and again
/// until the plane is tight: the back of a wall and what is seen past its edge go first.
class FrontPeeler {
 public:
  /// The 3×3 cells of 2^level pixels about cell (cx, cy), as far as they lie in the picture.
  void gather(const DotImage& dots, int level, int cx, int cy);

  /// Looks for the nearest surface among the gathered dots. A few dots before it, as a beam split by an
  /// edge leaves them, do not count.
  bool findSurface();

  /// Takes the surface found and what lies before it out of the block, so that the next one can be found.
  void dropSurface();

  /// The surface's inverse depth at (x, y) pixels from the block's middle.
  float at(float x, float y) const { return m_plane.w0 + m_plane.gx * x + m_plane.gy * y; }
  const Plane& plane() const { return m_plane; }
  /// In how many of the nine cells the surface has dots.
  int occupiedCells() const { return m_occupied; }
  /// True where a dot of the surface lies in each quadrant about (x, y), not much farther away than the
  /// surface's dots are from each other.
  bool encloses(float x, float y) const;
  /// True where the dot nearest to (x, y) is the surface's.
  bool isNearest(float x, float y) const;

 private:
  bool peel();
  void measureSpacing();

  std::vector<BlockDot> m_all, m_block, m_surface;
  Plane m_plane;
  float m_cellSize = 0, m_reachSquared = 0;
  int m_occupied = 0;
};

}  // namespace alidade
