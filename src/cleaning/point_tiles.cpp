// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/point_tiles.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace alidade {

PointTiles::PointTiles(std::span<const glm::dvec3> points, std::size_t mostPoints, bool planar) : m_points(points), m_planar(planar) {
  assert(points.size() < UINT32_MAX && mostPoints > 0);
  m_order.resize(points.size());
  std::iota(m_order.begin(), m_order.end(), 0u);
  if (!points.empty()) cut(0, points.size(), mostPoints);
}

void PointTiles::cut(std::size_t first, std::size_t last, std::size_t mostPoints) {
  Bounds bounds;
  for (std::size_t i = first; i < last; ++i) bounds.add(m_points[m_order[i]]);
  const glm::dvec3 size = bounds.size();
  const int axis = size.x >= size.y && (m_planar || size.x >= size.z) ? 0 : m_planar || size.y >= size.z ? 1 : 2;
  // Points on one spot cannot be parted.
  if (last - first <= mostPoints || size[axis] <= 0) {
    m_tiles.push_back({first, last, bounds});
    return;
  }
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t i) { return m_order.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(first), at(middle), at(last),
                   [&](std::uint32_t a, std::uint32_t b) { return m_points[a][axis] < m_points[b][axis]; });
  cut(first, middle, mostPoints);
  cut(middle, last, mostPoints);
}

std::vector<std::uint32_t> PointTiles::around(std::size_t tile, double margin) const {
  const auto mine = own(tile);
  std::vector<std::uint32_t> all(mine.begin(), mine.end());
  glm::dvec3 low = m_tiles[tile].bounds.min - margin, high = m_tiles[tile].bounds.max + margin;
  if (m_planar) low.z = -INFINITY, high.z = INFINITY;
  const auto inside = [&](const glm::dvec3& p) { return glm::all(glm::lessThanEqual(low, p)) && glm::all(glm::lessThanEqual(p, high)); };
  for (std::size_t other = 0; other < m_tiles.size(); ++other) {
    const Bounds& bounds = m_tiles[other].bounds;
    if (other == tile || glm::any(glm::greaterThan(bounds.min, high)) || glm::any(glm::lessThan(bounds.max, low))) continue;
    for (const std::uint32_t index : own(other))
      if (inside(m_points[index])) all.push_back(index);
  }
  return all;
}

}  // namespace alidade
