// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/node_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "cloud/cell_tree.h"

// Wider registers, but no instruction set with fused multiply-adds: the same spacing on every processor.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define ALIDADE_WIDE __attribute__((target_clones("avx", "default")))
#else
#define ALIDADE_WIDE
#endif

namespace alidade {

namespace {

constexpr std::size_t kNeighbours = 8;
constexpr std::size_t kPlaces = 7;
constexpr std::size_t kRun = 64;

struct Places {
  std::vector<float> x, y, z;
};

/// Squared distance from place `at` to its k-th nearest among the others.
ALIDADE_WIDE float neighbourDistanceSquared(const Places& p, std::size_t at, std::size_t k) {
  std::array<float, kNeighbours> nearest;
  nearest.fill(std::numeric_limits<float>::max());
  std::array<float, kRun> squared;
  const std::size_t count = p.x.size();
  const float *x = p.x.data(), *y = p.y.data(), *z = p.z.data();
  const float atX = x[at], atY = y[at], atZ = z[at];
  for (std::size_t first = 0; first < count; first += kRun) {
    const std::size_t n = std::min(kRun, count - first);
    for (std::size_t i = 0; i < n; ++i) {
      const float dx = x[first + i] - atX, dy = y[first + i] - atY, dz = z[first + i] - atZ;
      squared[i] = dx * dx + dy * dy + dz * dz;
    }
    std::array<float, 8> least;
    least.fill(std::numeric_limits<float>::max());
    for (std::size_t i = 0; i + 8 <= n; i += 8)
      for (std::size_t lane = 0; lane < 8; ++lane) least[lane] = squared[i + lane] < least[lane] ? squared[i + lane] : least[lane];
    if (n == kRun && *std::min_element(least.begin(), least.end()) >= nearest[k - 1]) continue;
    for (std::size_t i = 0; i < n; ++i) {
      if (squared[i] >= nearest[k - 1] || first + i == at) continue;
      std::size_t slot = k - 1;
      for (; slot > 0 && nearest[slot - 1] > squared[i]; --slot) nearest[slot] = nearest[slot - 1];
      nearest[slot] = squared[i];
    }
  }
  return nearest[k - 1];
}

}  // namespace

float spacingOf(std::span<const std::uint32_t> run, const CellPoints& points, std::size_t together) {
  if (run.size() < 2) return 0;
  Places places;
  places.x.reserve(run.size()), places.y.reserve(run.size()), places.z.reserve(run.size());
  for (const std::uint32_t i : run) places.x.push_back(points.x[i]), places.y.push_back(points.y[i]), places.z.push_back(points.z[i]);
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
