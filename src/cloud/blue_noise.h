// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "cloud/blue_noise_pass.h"
#include "cloud/raw_bytes.h"

namespace alidade {

/// Levels are counted in 64ths of an octave ("steps"), from where the spacing is 1024 lattice units:
/// spacing(level) = 1024 * 2^-level units. A tile of 2^16 units at level 0 has some 64 × 64 points on a surface.
constexpr int kLevelSteps = 64;
constexpr int kFinestPass = 10;    ///< spacing 1 unit: only coinciding points are rejected
constexpr int kCoarsestPass = -6;  ///< spacing 65536 units: a tile's own edge
constexpr int kDeepestLevelStep = 11 * kLevelSteps;  ///< of points that coincide with another

/// A sample that another cube has accepted at every pass q >= from: in this cube's tile's units, outside it.
struct Obstacle {
  std::int32_t x, y, z;
  std::int32_t from;
};

/// Points inside a tile in Morton order, columns parallel.
struct TilePoints {
  std::span<const std::uint64_t> code;  ///< Morton, in the tile
  std::span<const std::uint16_t> x, y, z;
};

/// Blue-noise levels, bottom-up (after Cook's Poisson disks, 1986, thinned octave by octave).
///
/// Pass q goes over the survivors of pass q+1 in Morton order and accepts a point where no accepted one lies
/// within 2^(10-q) units. A rejected point's level follows from its distance d to the nearest accepted one,
/// level = 10 - log2(d): so larger holes fill first, the sets nest, and the level is continuous. All numbers
/// that decide are whole and at most 2^24, exact in floats: the same levels on every processor.
class BlueNoise {
 public:
  /// Runs passes finest, finest-1, …, coarsest; writes the level, in steps, of every point that was rejected
  /// and returns the indices of those that survived, ascending. `settled`, where not empty, holds for each
  /// point the pass down to which it has been accepted already elsewhere.
  std::vector<std::uint32_t> thin(const TilePoints& points, std::span<const Obstacle> obstacles, int finest, int coarsest,
                                  std::span<std::int16_t> levels, std::span<const std::int8_t> settled = {});

 private:
  /// The survivors of a pass, padded by a register's width.
  struct Survivors {
    std::size_t count = 0, apart = 0;  ///< points, and the columns' room
    RawVector<std::uint32_t> index;
    RawVector<float> places;           ///< x, y, z, each `apart` after the other: units, halved as often as the pass asks
    float* column(std::size_t axis) { return places.data() + axis * apart; }
    glm::vec3 at(std::size_t i) const { return {places[i], places[apart + i], places[2 * apart + i]}; }
    void reserve(std::size_t points);
    void take(const blue_noise::Sample* samples, std::size_t points);
  };
  struct Spacing;
  struct Slot {
    std::uint64_t key = 0;  ///< 1 + the block's code; 0: empty
    std::uint32_t block = 0;
  };

  void runPass(int q, bool isFirst, const TilePoints& points, std::span<const Obstacle> obstacles, std::span<std::int16_t> levels,
               std::span<const std::int8_t> settled);
  void layBricks(const Spacing& spacing, std::span<const std::uint64_t> codes);
  void obstruct(const Spacing& spacing, std::span<const Obstacle> obstacles);
  Slot* slotOf(std::uint64_t code);
  /// The blocks beside the one of this code, and itself, of those whose code is below the limit.
  std::array<std::uint32_t, 27> blocksAround(std::uint64_t code, std::uint64_t limit);

  Survivors m_alive;
  RawVector<blue_noise::Sample> m_accepted, m_samplesNear;
  RawVector<std::uint8_t> m_splitBits;  ///< axis bits up to the highest in which a survivor and the one before it differ
  RawVector<float> m_squared;        ///< of each survivor's distance to the nearest accepted; -1: is one
  std::vector<blue_noise::Brick> m_bricks;
  std::vector<blue_noise::Block> m_blocks;
  std::vector<Slot> m_table;           ///< open addressing
  std::uint64_t m_tableMask = 0;
  int m_tableShift = 0;
  std::vector<Obstacle> m_near;        ///< Morton order
  std::vector<float> m_nearSquared;    ///< of the distance to the nearest obstacle, for points of bricks that have one
  std::vector<char> m_given;           ///< survivors that are accepted whatever is near
};

/// The finest pass worth running for points of these sorted Morton codes: the first at which a fair share
/// of the points has a neighbour.
int finestPassOf(std::span<const std::uint64_t> sortedCodes, int droppedBits);

}  // namespace alidade
