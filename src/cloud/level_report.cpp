// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/level_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

namespace alidade {

namespace {

/// Points by cubes of a given edge.
class Cubes {
 public:
  Cubes(std::span<const glm::dvec3> points, double edge) : m_points(points), m_edge(edge) {
    for (std::uint32_t i = 0; i < points.size(); ++i) m_cubes[keyOf(cubeOf(points[i]))].push_back(i);
  }

  /// From a place to the nearest point but `except`, metres; at most kRings edges.
  double nearest(const glm::dvec3& place, std::uint32_t except) const {
    const glm::i64vec3 cube = cubeOf(place);
    double squared = kRings * m_edge * kRings * m_edge;
    // What a ring holds lies at least ring - 1 edges away.
    for (std::int64_t ring = 0; ring <= kRings && (static_cast<double>(ring) - 1) * m_edge < std::sqrt(squared); ++ring)
      for (std::int64_t z = -ring; z <= ring; ++z)
        for (std::int64_t y = -ring; y <= ring; ++y) {
          const bool face = std::abs(z) == ring || std::abs(y) == ring;
          for (std::int64_t x = -ring; x <= ring; x += face || ring == 0 ? 1 : 2 * ring) look(cube + glm::i64vec3(x, y, z), place, except, squared);
        }
    return std::sqrt(squared);
  }

 private:
  static constexpr int kRings = 20;

  glm::i64vec3 cubeOf(const glm::dvec3& p) const { return glm::i64vec3(glm::floor(p / m_edge)); }
  static std::uint64_t keyOf(const glm::i64vec3& cube) {
    const auto part = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
    return part(cube.x) | part(cube.y) << 21 | part(cube.z) << 42;
  }
  void look(const glm::i64vec3& cube, const glm::dvec3& place, std::uint32_t except, double& squared) const {
    const auto found = m_cubes.find(keyOf(cube));
    if (found == m_cubes.end()) return;
    for (const std::uint32_t i : found->second) {
      const glm::dvec3 apart = m_points[i] - place;
      if (i != except) squared = std::min(squared, glm::dot(apart, apart));
    }
  }

  std::span<const glm::dvec3> m_points;
  double m_edge;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> m_cubes;
};

}  // namespace

LevelSpread spreadOf(std::span<const glm::dvec3> chosen, std::span<const glm::dvec3> surface, std::span<const double> areas) {
  LevelSpread spread;
  spread.points = chosen.size();
  const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
  if (chosen.size() < 2 || !(area > 0)) return spread;
  spread.idealM = std::sqrt(2 * area / (std::sqrt(3.0) * static_cast<double>(chosen.size())));
  const Cubes cubes(chosen, spread.idealM);
  for (std::uint32_t i = 0; i < chosen.size(); ++i) {
    const double spacing = cubes.nearest(chosen[i], i) / spread.idealM;
    spread.meanSpacing += spacing / static_cast<double>(chosen.size());
    spread.spacings[std::min<std::size_t>(static_cast<std::size_t>(spacing * 4), spread.spacings.size() - 1)] += 1.0 / static_cast<double>(chosen.size());
  }
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double away = cubes.nearest(surface[i], std::numeric_limits<std::uint32_t>::max()) / spread.idealM;
    if (away > 1) spread.holeArea += areas[i] / area;
    spread.largestHole = std::max(spread.largestHole, away);
  }
  return spread;
}

Selection selectShare(const PointStore& store, double share) {
  const double level = store.levelOfShare(share);
  Selection selection;
  for (std::uint32_t n = 0; n < store.nodes().size(); ++n) {
    const CloudNode& node = store.nodes()[n];
    const std::uint32_t count = store.countBelow(n, level);
    if (count == 0) continue;
    const double spacing = store.levelKind() == LevelKind::BlueNoise ? std::max(node.spacing, store.spacingOfLevel(level))
                                                                     : node.spacing / std::sqrt(std::clamp(share, 1e-9, 1.0));
    selection.ranges.push_back({n, node.first, count, spacing, nullptr});
    selection.pointCount += count;
  }
  return selection;
}

LevelSpread spreadOfShare(const PointStore& store, double share) {
  constexpr std::uint64_t kSurface = 200'000;
  std::vector<glm::dvec3> chosen, surface;
  std::vector<double> areas;
  for (const SelectedRange& range : selectShare(store, share).ranges)
    for (std::uint64_t p = range.first; p < range.first + range.count; ++p) chosen.push_back(store.sourcePosition(p));
  // Points stand in the order of their levels inside a node: every k-th is an even choice of all of them.
  const std::uint64_t step = std::max<std::uint64_t>(1, store.pointCount() / kSurface);
  for (std::uint64_t p = 0; p < store.pointCount(); p += step) {
    surface.push_back(store.sourcePosition(p));
    const double side = store.nodes()[store.nodeOf(p)].spacing;
    areas.push_back(static_cast<double>(step) * side * side);
  }
  return spreadOf(chosen, surface, areas);
}

}  // namespace alidade
