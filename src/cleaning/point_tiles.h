// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "geometry/bounds.h"

namespace alidade {

/// A cloud cut into boxes of few points by halving at the median, so that work which needs a search tree can
/// go box by box in bounded memory. The points must outlive it; at most 2^32 - 1.
class PointTiles {
 public:
  /// `planar`: cut along x and y alone, for work that looks at columns.
  PointTiles(std::span<const glm::dvec3> points, std::size_t mostPoints, bool planar);

  std::size_t count() const { return m_tiles.size(); }
  /// Indices of a tile's own points.
  std::span<const std::uint32_t> own(std::size_t tile) const {
    return std::span(m_order).subspan(m_tiles[tile].first, m_tiles[tile].last - m_tiles[tile].first);
  }
  const Bounds& bounds(std::size_t tile) const { return m_tiles[tile].bounds; }
  /// The tile's own points, in the order of own(), then those of others within `margin` metres of its
  /// bounds (in x and y alone where planar).
  std::vector<std::uint32_t> around(std::size_t tile, double margin) const;

 private:
  struct Tile {
    std::size_t first, last;
    Bounds bounds;
  };
  void cut(std::size_t first, std::size_t last, std::size_t mostPoints);

  std::span<const glm::dvec3> m_points;
  bool m_planar;
  std::vector<std::uint32_t> m_order;
  std::vector<Tile> m_tiles;
};

}  // namespace alidade
