// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <vector>

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
  std::span<const std::uint16_t> x, y, z;
};

/// Blue-noise levels, bottom-up (after Cook's Poisson disks, 1986, thinned octave by octave).
///
/// Pass q goes over the survivors of pass q+1 in Morton order and accepts a point where no accepted one lies
/// within 2^(10-q) units. A rejected point's level follows from its distance d to the nearest accepted one,
/// level = 10 - log2(d): so larger holes fill first, the sets nest, and the level is continuous. Integers
/// throughout: the same levels on every processor.
class BlueNoise {
 public:
  /// Runs passes finest, finest-1, …, coarsest; writes the level, in steps, of every point that was rejected
  /// and returns the indices of those that survived, ascending. `settled`, where not empty, holds for each
  /// point the pass down to which it has been accepted already elsewhere.
  std::vector<std::uint32_t> thin(const TilePoints& points, std::span<const Obstacle> obstacles, int finest, int coarsest,
                                  std::span<std::int16_t> levels, std::span<const std::int8_t> settled = {});

 private:
  struct Set {
    std::vector<std::uint32_t> index;
    std::vector<std::uint16_t> x, y, z;
    void clear();
    void push(const Set& from, std::size_t i);
    std::size_t size() const { return index.size(); }
  };
  struct Brick {
    std::uint32_t first = 0, last = 0;                  ///< of the survivors that went in
    std::uint32_t acceptedFirst = 0, acceptedLast = 0;  ///< of m_accepted
    std::uint32_t obstacleFirst = 0, obstacleLast = 0;  ///< of m_near
    std::int32_t x = 0, y = 0, z = 0;
  };
  struct Pass;

  void runPass(int q, bool isFirst, std::span<const Obstacle> obstacles, std::span<std::int16_t> levels,
               std::span<const std::int8_t> settled);
  void layBricks(const Pass& pass, std::span<const Obstacle> obstacles);
  std::uint32_t* slotOf(std::int32_t x, std::int32_t y, std::int32_t z);
  void gather(const Pass& pass, const Brick& brick, bool own);
  void addCandidate(std::int32_t x, std::int32_t y, std::int32_t z);
  void padCandidates();

  Set m_alive, m_accepted;
  std::vector<char> m_rejected;
  std::vector<Brick> m_bricks;
  std::vector<std::uint32_t> m_table;  ///< open addressing: 1 + brick
  std::uint64_t m_tableMask = 0;
  int m_tableShift = 0;
  std::vector<Obstacle> m_near;
  std::vector<std::int32_t> m_cx, m_cy, m_cz;  ///< candidates about the brick at hand
  std::size_t m_candidates = 0;
};

/// The finest pass worth running for points of these sorted Morton codes: the first at which a fair share
/// of the points has a neighbour.
int finestPassOf(std::span<const std::uint64_t> sortedCodes, int droppedBits);

}  // namespace alidade
