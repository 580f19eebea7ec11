// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/node_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

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
constexpr std::size_t kRun = 64;

/// Places in Morton order, and the boxes of each kRun of them.
struct Places {
  std::vector<float> x, y, z;
  struct Box {
    std::array<float, 3> low, high;
  };
  std::vector<Box> boxes;

  /// Rounded as the points' own distances are: never more than that of a point inside.
  float squaredDistanceTo(const Box& box, std::size_t at) const {
    float squared = 0;
    for (const auto& [value, axis] : {std::pair{x[at], 0}, std::pair{y[at], 1}, std::pair{z[at], 2}}) {
      const float apart = std::max({box.low[static_cast<std::size_t>(axis)] - value, value - box.high[static_cast<std::size_t>(axis)], 0.0f});
      squared += apart * apart;
    }
    return squared;
  }
};

ALIDADE_WIDE void findBoxes(Places& p) {
  const std::array<const float*, 3> columns{p.x.data(), p.y.data(), p.z.data()};
  for (std::size_t first = 0; first < p.x.size(); first += kRun) {
    const std::size_t last = std::min(first + kRun, p.x.size());
    Places::Box& box = p.boxes.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      float low = columns[axis][first], high = low;
      for (std::size_t i = first; i < last; ++i) {
        low = columns[axis][i] < low ? columns[axis][i] : low;
        high = columns[axis][i] > high ? columns[axis][i] : high;
      }
      box.low[axis] = low, box.high[axis] = high;
    }
  }
}

using Nearest = std::array<float, kNeighbours>;

/// Takes the run's places other than `at` among the k nearest.
ALIDADE_WIDE void look(const Places& p, std::size_t run, std::size_t at, std::size_t k, Nearest& nearest) {
  std::array<float, kRun> squared;
  const std::size_t first = run * kRun, n = std::min(kRun, p.x.size() - first);
  const float *x = p.x.data() + first, *y = p.y.data() + first, *z = p.z.data() + first;
  const float atX = p.x[at], atY = p.y[at], atZ = p.z[at];
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = x[i] - atX, dy = y[i] - atY, dz = z[i] - atZ;
    squared[i] = dx * dx + dy * dy + dz * dz;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (squared[i] >= nearest[k - 1] || first + i == at) continue;
    std::size_t slot = k - 1;
    for (; slot > 0 && nearest[slot - 1] > squared[i]; --slot) nearest[slot] = nearest[slot - 1];
    nearest[slot] = squared[i];
  }
}

/// Squared distance from place `at` to its k-th nearest among the others.
float neighbourDistanceSquared(const Places& p, std::size_t at, std::size_t k) {
  Nearest nearest;
  nearest.fill(std::numeric_limits<float>::max());
  look(p, at / kRun, at, k, nearest);
  for (std::size_t run = 0; run < p.boxes.size(); ++run)
    if (run != at / kRun && p.squaredDistanceTo(p.boxes[run], at) < nearest[k - 1]) look(p, run, at, k, nearest);
  return nearest[k - 1];
}

}  // namespace

float spacingOf(std::span<const std::uint32_t> run, const CellPoints& points, std::size_t together) {
  if (run.size() < 2) return 0;
  Places places;
  places.x.reserve(run.size()), places.y.reserve(run.size()), places.z.reserve(run.size());
  for (const std::uint32_t i : run) places.x.push_back(points.x[i]), places.y.push_back(points.y[i]), places.z.push_back(points.z[i]);
  findBoxes(places);
  const std::size_t k = std::min(kNeighbours, run.size() - 1), count = std::min(kPlaces, run.size());
  std::vector<double> sides;
  for (std::size_t i = 0; i < count; ++i) {
    const double squared = neighbourDistanceSquared(places, (2 * i + 1) * run.size() / (2 * count), k);
    sides.push_back(std::sqrt(std::numbers::pi * squared / static_cast<double>(k)));
  }
  std::nth_element(sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2), sides.end());
  const double side = sides[sides.size() / 2];
  return static_cast<float>(side * std::sqrt(static_cast<double>(run.size()) / static_cast<double>(std::max(together, run.size()))));
}

}  // namespace alidade
