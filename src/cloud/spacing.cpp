// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr std::uint32_t kNeighbours = 8;
constexpr std::uint32_t kPlaces = 12;

/// Squared distance in steps from point `place` to its k-th nearest among the others.
float neighbourDistanceSquared(std::span<const DisplayPoint> points, std::uint32_t place, std::uint32_t k) {
  std::array<float, kNeighbours> nearest;
  nearest.fill(std::numeric_limits<float>::max());
  const DisplayPoint centre = points[place];
  constexpr std::size_t kRun = 64;
  std::array<float, kRun> distance;
  for (std::size_t first = 0; first < points.size(); first += kRun) {
    const std::size_t count = std::min(kRun, points.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const DisplayPoint& p = points[first + i];
      const auto dx = static_cast<float>(p.x - centre.x), dy = static_cast<float>(p.y - centre.y),
                 dz = static_cast<float>(p.z - centre.z);
      distance[i] = dx * dx + dy * dy + dz * dz;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (distance[i] >= nearest[k - 1] || first + i == place) continue;
      std::uint32_t slot = k - 1;
      for (; slot > 0 && nearest[slot - 1] > distance[i]; --slot) nearest[slot] = nearest[slot - 1];
      nearest[slot] = distance[i];
    }
  }
  return nearest[k - 1];
}

struct WeightedSpacing {
  double spacing;
  double weight;
};

/// The node's own spacing scaled to all levels, at up to kPlaces places.
std::vector<WeightedSpacing> spacingsOf(const CloudNode& node, const OctreeNodeLevels& levels,
                                        std::span<const DisplayPoint> points, const LevelLaw& law) {
  std::vector<WeightedSpacing> found;
  if (node.count < 2) return found;
  const std::span<const DisplayPoint> own = points.subspan(node.first, node.count);
  const std::uint32_t k = std::min(kNeighbours, node.count - 1);
  const std::uint32_t places = std::min(kPlaces, node.count);
  const double share = law.shareBelow(levels.to) - law.shareBelow(levels.from);
  for (std::uint32_t i = 0; i < places; ++i) {
    const auto place = static_cast<std::uint32_t>(static_cast<std::uint64_t>(i) * node.count / places);
    const double squared = neighbourDistanceSquared(own, place, k);
    found.push_back({node.step * std::sqrt(std::numbers::pi * squared / k * std::clamp(share, 0.0, 1.0)),
                     static_cast<double>(node.count) / places});
  }
  return found;
}

/// Reorders its argument.
double weightedMedian(std::vector<WeightedSpacing>& samples) {
  std::sort(samples.begin(), samples.end(),
            [](const auto& a, const auto& b) { return a.spacing < b.spacing; });
  double total = 0;
  for (const auto& sample : samples) total += sample.weight;
  double below = 0;
  for (const auto& sample : samples) {
    below += sample.weight;
    if (2 * below >= total) return sample.spacing;
  }
  return 0;
}

}  // namespace

double measureSpacing(std::span<CloudNode> nodes, std::span<const OctreeNodeLevels> levels,
                      std::span<const DisplayPoint> points, const LevelLaw& law) {
  std::vector<std::vector<WeightedSpacing>> ofNode(nodes.size());
  parallelFor(nodes.size(), 4, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      ofNode[i] = spacingsOf(nodes[i], levels[i], points, law);
      nodes[i].spacing = weightedMedian(ofNode[i]);
    }
  });
  std::vector<WeightedSpacing> all;
  for (const auto& samples : ofNode) all.insert(all.end(), samples.begin(), samples.end());
  const double median = weightedMedian(all);
  // A lone point tells no spacing: its surroundings' is the best guess. Children follow parents.
  for (CloudNode& node : nodes) {
    if (node.count == 1) node.spacing = median;
    if (node.count == 0) node.spacing = median;
  }
  return median;
}

}  // namespace alidade
