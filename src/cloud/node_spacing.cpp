// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/node_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

#include "cloud/cell_tree.h"

// The widest registers the processor has. The build fuses nothing here: the same spacing on every processor.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define ALIDADE_WIDE __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ALIDADE_WIDE
#endif

namespace alidade {

namespace {

constexpr std::size_t kNeighbours = 8;
constexpr std::size_t kPlaces = 7;

/// A node's points, and the boxes of the stretches of its cell that hold them.
struct Places {
  std::span<const std::uint32_t> run;  ///< indices into the cell's points, ascending
  const CellPoints& points;
  std::span<const PlaceBox> boxes;

  glm::vec3 at(std::uint32_t i) const { return {points.x[i], points.y[i], points.z[i]}; }
};

/// Rounded as the points' own distances are: never more than that of a point inside.
float squaredDistanceTo(const PlaceBox& box, const glm::vec3& place) {
  float squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    const float apart = std::max({static_cast<float>(box.low[at]) - place[axis], place[axis] - static_cast<float>(box.high[at]), 0.0f});
    squared += apart * apart;
  }
  return squared;
}

using Nearest = std::array<float, kNeighbours>;

/// Takes the node's points of a stretch, other than `self`, among the k nearest.
void look(const Places& p, std::size_t stretch, std::uint32_t self, const glm::vec3& place, std::size_t k, Nearest& nearest) {
  const auto first = std::lower_bound(p.run.begin(), p.run.end(), stretch * kPlacesInBox);
  for (auto i = first; i != p.run.end() && *i < (stretch + 1) * kPlacesInBox; ++i) {
    const glm::vec3 apart = p.at(*i) - place;
    const float squared = apart.x * apart.x + apart.y * apart.y + apart.z * apart.z;
    if (squared >= nearest[k - 1] || *i == self) continue;
    std::size_t slot = k - 1;
    for (; slot > 0 && nearest[slot - 1] > squared; --slot) nearest[slot] = nearest[slot - 1];
    nearest[slot] = squared;
  }
}

/// Squared distance from a point to its k-th nearest among the node's others.
float neighbourDistanceSquared(const Places& p, std::uint32_t self, std::size_t k) {
  Nearest nearest;
  nearest.fill(std::numeric_limits<float>::max());
  const glm::vec3 place = p.at(self);
  const std::size_t own = self / kPlacesInBox;
  look(p, own, self, place, k, nearest);
  const std::size_t first = p.run.front() / kPlacesInBox, last = p.run.back() / kPlacesInBox;
  for (std::size_t stretch = first; stretch <= last; ++stretch)
    if (stretch != own && squaredDistanceTo(p.boxes[stretch], place) < nearest[k - 1]) look(p, stretch, self, place, k, nearest);
  return nearest[k - 1];
}

ALIDADE_WIDE void findBox(const std::uint16_t* column, std::size_t count, std::uint16_t* low, std::uint16_t* high) {
  std::uint16_t least = column[0], most = column[0];
  for (std::size_t i = 1; i < count; ++i) {
    least = column[i] < least ? column[i] : least;
    most = column[i] > most ? column[i] : most;
  }
  *low = least, *high = most;
}

}  // namespace

std::vector<PlaceBox> boxesOf(const CellPoints& points) {
  std::vector<PlaceBox> boxes((points.size() + kPlacesInBox - 1) / kPlacesInBox);
  const std::array<const std::uint16_t*, 3> columns{points.x.data(), points.y.data(), points.z.data()};
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const std::size_t first = b * kPlacesInBox, count = std::min(kPlacesInBox, points.size() - first);
    for (std::size_t axis = 0; axis < 3; ++axis) findBox(columns[axis] + first, count, &boxes[b].low[axis], &boxes[b].high[axis]);
  }
  return boxes;
}

float spacingOf(std::span<const std::uint32_t> run, const CellPoints& points, std::span<const PlaceBox> boxes, std::size_t together) {
  if (run.size() < 2) return 0;
  const Places places{run, points, boxes};
  const std::size_t k = std::min(kNeighbours, run.size() - 1), count = std::min(kPlaces, run.size());
  std::vector<double> sides;
  for (std::size_t i = 0; i < count; ++i) {
    const double squared = neighbourDistanceSquared(places, run[(2 * i + 1) * run.size() / (2 * count)], k);
    sides.push_back(std::sqrt(std::numbers::pi * squared / static_cast<double>(k)));
  }
  std::nth_element(sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2), sides.end());
  const double side = sides[sides.size() / 2];
  return static_cast<float>(side * std::sqrt(static_cast<double>(run.size()) / static_cast<double>(std::max(together, run.size()))));
}

}  // namespace alidade
