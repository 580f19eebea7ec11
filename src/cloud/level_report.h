// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "cloud/point_store.h"
#include "cloud/selection.h"

namespace alidade {

/// How evenly some points stand for a surface. Lengths are shares of the ideal: what is between neighbours where as
/// many points stand hexagonally on the same area, sqrt(2 A / (sqrt(3) n)).
struct LevelSpread {
  std::uint64_t points = 0;
  double idealM = 0;                  ///< metres
  double meanSpacing = 0;             ///< from each point to its nearest: 1 is ideal, 0.5 / sqrt(n / A) ≈ 0.47 a plane's random points
  std::array<double, 8> spacings{};   ///< share of the points by spacing: below 0.25, 0.5, …; the last holds the rest
  double holeArea = 0;                ///< share of the surface that is farther than the ideal from every point; none is, ideally
  double largestHole = 0;             ///< the farthest that any of the surface is; 0.58 ideally
};

/// `surface` are points all over it, each standing for `areas` square metres.
LevelSpread spreadOf(std::span<const glm::dvec3> chosen, std::span<const glm::dvec3> surface, std::span<const double> areas);

/// The store's points below the level that holds this share of them, as ranges to draw.
Selection selectShare(const PointStore& store, double share);

/// Of what selectShare chooses, against all of the store's points.
LevelSpread spreadOfShare(const PointStore& store, double share);

}  // namespace alidade
