// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/lattice.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/widest.h"

namespace alidade {

namespace {

/// Tiles are counted in 20 bits and a sign an axis.
constexpr double kFarthestUnit = 0x1p35;

/// Tiles with fewer points than this cost more than they bring.
constexpr double kTilePoints = 20000;

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// The source's integer behind a coordinate; false where there is none.
bool integerOf(double position, double scale, double offset, std::int64_t& out) {
  const double integer = std::nearbyint((position - offset) / scale);
  if (!(std::abs(integer) < 0x1p52)) return false;
  out = static_cast<std::int64_t>(integer);
  return sameBits(scale * integer + offset, position);
}

/// Points a tile where units are `step` metres: from the sample's occupied tiles.
double pointsPerTile(const LatticeEvidence& evidence, double step) {
  if (evidence.sample.empty()) return std::numeric_limits<double>::infinity();
  const double tile = step * 65536.0;
  std::vector<std::uint64_t> tiles;
  tiles.reserve(evidence.sample.size());
  for (const glm::dvec3& p : evidence.sample) {
    const glm::dvec3 at = glm::floor((p - evidence.bounds.min) / tile);
    const auto part = [](double v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) & 0x1fffff; };
    tiles.push_back(part(at.x) | part(at.y) << 21 | part(at.z) << 42);
  }
  std::sort(tiles.begin(), tiles.end());
  const auto occupied = std::unique(tiles.begin(), tiles.end()) - tiles.begin();
  return static_cast<double>(std::max<std::uint64_t>(evidence.pointCount, evidence.sample.size())) / static_cast<double>(occupied);
}

/// The finest power of two worth having: between 2^-20 m and 2^-10 m, coarser where the points are far
/// apart or the extent would not fit the tiles' counters.
double floatingStep(const LatticeEvidence& evidence, double finest) {
  const glm::dvec3 size = evidence.bounds.size();
  const double extent = std::max({size.x, size.y, size.z, 1e-3});
  double step = std::exp2(std::ceil(std::log2(extent * 0x1p-18)));
  step = std::clamp(step, 0x1p-20, 0x1p-10);
  if (finest > 0) step = std::max(step, std::exp2(std::floor(std::log2(finest))));
  while (step < 0x1p-12 && pointsPerTile(evidence, step) < kTilePoints) step *= 2;
  // Scattered points: what matters is a thousandth of the distance between them.
  const double count = static_cast<double>(std::max<std::uint64_t>(evidence.pointCount, 1));
  step = std::max(step, std::exp2(std::floor(std::log2(extent / std::sqrt(count) / 4096.0))) > 0x1p-8
                            ? std::exp2(std::floor(std::log2(extent / std::sqrt(count) / 4096.0)))
                            : step);
  const double reach = std::max(glm::length(evidence.bounds.min), glm::length(evidence.bounds.max));
  while (extent / step > kFarthestUnit / 8 || reach / step > 0x1p50) step *= 2;
  return step;
}

bool allFloats(std::span<const glm::dvec3> sample) {
  return std::all_of(sample.begin(), sample.end(), [](const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)) == p; });
}

/// What turns coordinates into units, for a run of them, x, y, z, x, y, z, …
struct LatticeAxes {
  static constexpr std::size_t kPeriod = 24;  ///< of points' axes and of registers
  std::array<double, kPeriod> scale, offset;
  std::array<std::int64_t, kPeriod> corner;
  bool exact;

  explicit LatticeAxes(const Lattice& lattice) : exact(lattice.exact == ExactCoordinates::Lattice) {
    for (std::size_t i = 0; i < kPeriod; ++i) {
      const int axis = static_cast<int>(i % 3);
      scale[i] = exact ? lattice.scale[axis] : lattice.step;
      offset[i] = exact ? lattice.offset[axis] : 0;
      corner[i] = lattice.corner[axis];
    }
  }
};

ALIDADE_WIDEST bool areUsable(const double* coordinates, std::size_t count) {
  constexpr double kFarthestMeters = 1e8;
  std::uint64_t wrong = 0;
  // NaN fails every comparison.
  for (std::size_t i = 0; i < count; ++i) wrong |= static_cast<std::uint64_t>(!(std::abs(coordinates[i]) <= kFarthestMeters));
  return wrong == 0;
}

/// False where a coordinate is not on the lattice, or beyond what tiles can count.
ALIDADE_WIDEST bool unitsOfBlock(const LatticeAxes& axes, const double* positions, std::size_t count, std::int64_t* units) {
  constexpr auto kFarthest = static_cast<std::int64_t>(kFarthestUnit);
  constexpr std::size_t kPeriod = LatticeAxes::kPeriod;
  std::uint64_t wrong = 0;
  const auto convert = [&](std::size_t i, std::size_t at) {
    const double p = positions[i], steps = (p - axes.offset[at]) / axes.scale[at];
    const double whole = axes.exact ? std::nearbyint(steps) : std::floor(steps);
    const bool counts = std::abs(whole) < 0x1p52;
    const double kept = counts ? whole : 0.0;
    const double again = axes.scale[at] * kept + axes.offset[at];
    const auto different = std::bit_cast<std::uint64_t>(again) ^ std::bit_cast<std::uint64_t>(p);
    const std::int64_t unit = static_cast<std::int64_t>(kept) - axes.corner[at];
    units[i] = unit;
    wrong |= (axes.exact ? different : 0) | static_cast<std::uint64_t>(!counts) | static_cast<std::uint64_t>(unit <= -kFarthest || unit >= kFarthest);
  };
  std::size_t i = 0;
  for (; i + kPeriod <= count; i += kPeriod)
    for (std::size_t at = 0; at < kPeriod; ++at) convert(i + at, at);
  for (; i < count; ++i) convert(i, i % 3);
  return wrong == 0;
}

}  // namespace

bool isUsablePosition(const glm::dvec3& p) {
  return areUsable(&p.x, 3);
}

bool areUsablePositions(std::span<const glm::dvec3> positions) {
  return positions.empty() || areUsable(&positions[0].x, 3 * positions.size());
}

bool Lattice::unitsOf(std::span<const glm::dvec3> positions, glm::i64vec3* units, std::size_t* failedAt) const {
  constexpr std::size_t kBlock = 64;
  const LatticeAxes axes(*this);
  for (std::size_t first = 0; first < positions.size(); first += kBlock) {
    const std::size_t count = std::min(kBlock, positions.size() - first);
    if (unitsOfBlock(axes, &positions[first].x, 3 * count, &units[first].x)) continue;
    std::size_t at = 0;
    while (unitsOfBlock(axes, &positions[first + at].x, 3, &units[first + at].x)) ++at;
    if (failedAt != nullptr) *failedAt = first + at;
    return false;
  }
  return true;
}

bool Lattice::counts(const glm::i64vec3& unit) {
  constexpr auto kFarthest = static_cast<std::int64_t>(kFarthestUnit);
  return glm::all(glm::lessThan(glm::abs(unit), glm::i64vec3(kFarthest)));
}

std::size_t Lattice::exactBytes() const {
  switch (exact) {
    case ExactCoordinates::Lattice: return 0;
    case ExactCoordinates::Int32:
    case ExactCoordinates::Float32: return 12;
    case ExactCoordinates::Float64: return 24;
  }
  return 0;
}

bool Lattice::packExact(const glm::dvec3& position, std::byte* out) const {
  switch (exact) {
    case ExactCoordinates::Lattice: return true;
    case ExactCoordinates::Int32: {
      std::int32_t integers[3];
      for (int axis = 0; axis < 3; ++axis) {
        std::int64_t integer = 0;
        if (!integerOf(position[axis], scale[axis], offset[axis], integer)) return false;
        if (integer < std::numeric_limits<std::int32_t>::min() || integer > std::numeric_limits<std::int32_t>::max()) return false;
        integers[axis] = static_cast<std::int32_t>(integer);
      }
      std::memcpy(out, integers, sizeof integers);
      return true;
    }
    case ExactCoordinates::Float32: {
      const float floats[3] = {static_cast<float>(position.x), static_cast<float>(position.y), static_cast<float>(position.z)};
      for (int axis = 0; axis < 3; ++axis)
        if (!sameBits(floats[axis], position[axis])) return false;
      std::memcpy(out, floats, sizeof floats);
      return true;
    }
    case ExactCoordinates::Float64: std::memcpy(out, &position, 3 * sizeof(double)); return true;
  }
  return false;
}

glm::dvec3 Lattice::unpackExact(const std::byte* bytes) const {
  if (exact == ExactCoordinates::Int32) {
    std::int32_t v[3];
    std::memcpy(v, bytes, sizeof v);
    return scale * glm::dvec3(v[0], v[1], v[2]) + offset;
  }
  if (exact == ExactCoordinates::Float32) {
    float v[3];
    std::memcpy(v, bytes, sizeof v);
    return {v[0], v[1], v[2]};
  }
  glm::dvec3 position(0);
  std::memcpy(&position, bytes, 3 * sizeof(double));
  return position;
}

Lattice chooseLattice(const LatticeEvidence& evidence, int attempt) {
  Lattice lattice;
  lattice.scale = evidence.scale;
  lattice.offset = evidence.offset;
  const bool integers = glm::all(glm::greaterThan(evidence.scale, glm::dvec3(0))) && std::isfinite(glm::length(evidence.scale)) &&
                        std::isfinite(glm::length(evidence.offset));
  const bool cubic = evidence.scale.x == evidence.scale.y && evidence.scale.x == evidence.scale.z;
  const glm::dvec3 size = evidence.bounds.size();
  const double extent = std::max({size.x, size.y, size.z});

  if (integers && cubic && attempt == 0) {
    lattice.exact = ExactCoordinates::Lattice;
    lattice.step = evidence.scale.x;
    const bool wideEnough = lattice.step >= 2e-4 || pointsPerTile(evidence, lattice.step) >= kTilePoints;
    std::vector<glm::i64vec3> units(evidence.sample.size());
    if (wideEnough && extent / lattice.step < kFarthestUnit / 8 && lattice.unitsOf(evidence.sample, units.data(), nullptr)) {
      if (!evidence.bounds.empty())
        lattice.corner = glm::i64vec3(glm::floor((evidence.bounds.min - lattice.offset) / lattice.scale)) - glm::i64vec3(1);
      return lattice;
    }
  }
  lattice.exact = ExactCoordinates::Float64;
  std::byte scratch[24];
  const auto holdsSample = [&](ExactCoordinates kind) {
    lattice.exact = kind;
    return std::all_of(evidence.sample.begin(), evidence.sample.end(),
                       [&](const glm::dvec3& p) { return lattice.packExact(p, scratch); });
  };
  if (integers && attempt <= 1 && holdsSample(ExactCoordinates::Int32)) {
    lattice.exact = ExactCoordinates::Int32;
  } else if ((attempt == 0 || evidence.wholeSample) && allFloats(evidence.sample) && holdsSample(ExactCoordinates::Float32)) {
    lattice.exact = ExactCoordinates::Float32;
  } else {
    lattice.exact = ExactCoordinates::Float64;
  }
  const double finest = integers ? std::min({evidence.scale.x, evidence.scale.y, evidence.scale.z}) : 0.0;
  lattice.step = floatingStep(evidence, finest);
  // A last attempt counts on nothing that the header says of the extent.
  if (attempt >= 2) lattice.step = std::max(lattice.step, 1.0 / 64);
  if (!evidence.bounds.empty())
    lattice.corner = glm::i64vec3(glm::floor(evidence.bounds.min / lattice.step)) - glm::i64vec3(1);
  return lattice;
}

}  // namespace alidade
