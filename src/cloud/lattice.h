// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include "geometry/bounds.h"

namespace alidade {

/// What a point's exact source coordinate is made of.
enum class ExactCoordinates : std::uint8_t {
  Lattice,  ///< its place on the lattice: position = scale * integer + offset
  Int32,    ///< a column of the source's integers, with the source's own scale and offset
  Float32,  ///< a column of floats that equal the source's doubles
  Float64,  ///< a column of the source's doubles
};

/// The integer grid that a store's points are shown on, cut into cubes of 2^16 units ("tiles").
///
/// With ExactCoordinates::Lattice a unit is the source's own coordinate step and nothing is rounded.
/// Otherwise a unit is a power of two fine enough to look at, a point is shown at its cell's middle, and
/// the exact coordinate stands in a column beside.
struct Lattice {
  ExactCoordinates exact = ExactCoordinates::Float64;
  double step = 1.0 / 4096;     ///< metres a unit
  glm::dvec3 scale{0};          ///< of the source's integers (Lattice, Int32)
  glm::dvec3 offset{0};         ///< of the source's integers; where Lattice counts from
  glm::i64vec3 corner{0};       ///< unit where tile (0,0,0) begins

  static constexpr int kTileBits = 16;

  /// The unit's place in the world, metres: exact for Lattice, the cell's middle otherwise.
  glm::dvec3 positionOf(const glm::i64vec3& unit) const {
    if (exact == ExactCoordinates::Lattice) return scale * glm::dvec3(unit) + offset;
    return (glm::dvec3(unit) + 0.5) * step;
  }

  /// The units of `positions`, relative to the corner. Marks by a false return a position that is not
  /// exactly on the lattice, or beyond what tiles can count; `failedAt` is its index.
  bool unitsOf(std::span<const glm::dvec3> positions, glm::i64vec3* units, std::size_t* failedAt) const;

  /// Whether tiles reach to this unit, relative to the corner.
  static bool counts(const glm::i64vec3& unit);
  /// Bytes a point of the exact column; 0 where there is none.
  std::size_t exactBytes() const;
  /// Writes the exact column's value of a position; false where it does not come back bit for bit.
  bool packExact(const glm::dvec3& position, std::byte* out) const;
  glm::dvec3 unpackExact(const std::byte* bytes) const;

  friend bool operator==(const Lattice&, const Lattice&) = default;
};

/// False for a point that is not finite, or farther than 10^8 m from the origin (no survey's coordinates
/// are; one such point would cost all others their resolution).
bool isUsablePosition(const glm::dvec3& position);
/// None of them is such.
bool areUsablePositions(std::span<const glm::dvec3> positions);

/// What is known of the source's coordinates when the lattice is chosen.
struct LatticeEvidence {
  glm::dvec3 scale{0}, offset{0};           ///< ScanInfo's; 0 where floating
  Bounds bounds;                            ///< header's and sample's together
  std::uint64_t pointCount = 0;
  std::span<const glm::dvec3> sample;       ///< usable positions
  bool wholeSample = false;                 ///< the sample is all there is
};

/// The lattice for a source, and the next safer one where a point was met that the chosen one does not hold.
Lattice chooseLattice(const LatticeEvidence& evidence, int attempt);

}  // namespace alidade
