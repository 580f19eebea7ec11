// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace alidade {

struct CellPoints;

/// Samples of a maximal Poisson-disk set of distance r on a surface: one a square of side kPoissonSide * r.
/// Measured on planes thinned by BlueNoise, which is a little sparser than random dart throwing.
constexpr double kPoissonSide = 1.35;

/// The box of a stretch of kPlacesInBox points of a cell, both ends inside.
struct PlaceBox {
  std::array<std::uint16_t, 3> low, high;
};
constexpr std::size_t kPlacesInBox = 64;

/// The boxes of a cell's points, a stretch after the other.
std::vector<PlaceBox> boxesOf(const CellPoints& points);

/// Side of a square of surface that holds one point, in units, where all levels are drawn; 0 for fewer than two
/// distinct points. `run` are a node's own points, ascending, of `together` that lie in its cube.
///
/// A surface with rho points a unit² has k of them within r_k with E[pi rho r_k²] = k, so sqrt(pi r_k² / k)
/// estimates that side. It is taken from the 8th neighbour among the node's own points at a few places, and
/// scaled to all that lie there.
float spacingOf(std::span<const std::uint32_t> run, const CellPoints& points, std::span<const PlaceBox> boxes, std::size_t together);

}  // namespace alidade
