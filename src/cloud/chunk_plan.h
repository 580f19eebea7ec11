// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <glm/glm.hpp>

namespace alidade {

/// A cell of one tile, cut `depth` times an axis: what one thread turns into a subtree at a time.
struct PlanCell {
  glm::ivec3 tile{0};
  std::uint8_t depth = 0;
  glm::u16vec3 cell{0};

  std::int32_t size() const { return std::int32_t{1} << (16 - depth); }           ///< units
  glm::ivec3 corner() const { return glm::ivec3(cell) << glm::ivec3(16 - depth); }  ///< units, in the tile
  friend bool operator==(const PlanCell&, const PlanCell&) = default;
};

/// Morton order over all tiles, then inside the tile.
bool mortonLess(const PlanCell& a, const PlanCell& b);

struct TileHash {
  std::size_t operator()(const glm::ivec3& t) const {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(t.x)) * 0x9e3779b97f4a7c15ull) ^
           (static_cast<std::uint64_t>(static_cast<std::uint32_t>(t.y)) * 0xbf58476d1ce4e5b9ull) ^
           (static_cast<std::uint64_t>(static_cast<std::uint32_t>(t.z)) * 0x94d049bb133111ebull);
  }
};

/// Which cells a scan is cut into, from a sample: each with at most `cellPoints` points or so, whole tiles
/// where that holds. Consecutive small cells share a stream, so that a stream is worth a buffer.
class ChunkPlan {
 public:
  /// `sample` in units from the lattice's corner. The same sample gives the same plan.
  ChunkPlan(std::span<const glm::i64vec3> sample, std::uint64_t pointCount, std::uint64_t cellPoints);

  const std::vector<PlanCell>& cells() const { return m_cells; }
  std::uint32_t streamOf(std::uint32_t cell) const { return m_streams[cell]; }
  std::uint32_t streamCount() const { return m_streamCount; }

  static constexpr std::uint32_t kNone = 0xffffffff;

 private:
  struct TileGrid {
    int depth = 0;  ///< of the finest cell
    std::vector<std::uint32_t> grid;
  };

  std::vector<PlanCell> m_cells;  ///< Morton order
  std::vector<std::uint32_t> m_streams;
  std::uint32_t m_streamCount = 0;
  std::unordered_map<glm::ivec3, TileGrid, TileHash> m_tiles;
  friend class CellFinder;
};

/// Looks cells up; remembers tiles that it met, as a scan's order comes back to them. One a thread.
class CellFinder {
 public:
  explicit CellFinder(const ChunkPlan& plan) : m_plan(plan) {}

  /// The cell that holds a place of a tile, or ChunkPlan::kNone for a tile that the sample did not meet.
  std::uint32_t find(const glm::ivec3& tile, const glm::u16vec3& place) {
    Met& met = m_met[static_cast<std::size_t>((tile.x & 3) | (tile.y & 3) << 2 | (tile.z & 3) << 4)];
    if (tile != met.tile || met.grid == nullptr) {
      const auto found = m_plan.m_tiles.find(tile);
      if (found == m_plan.m_tiles.end()) return ChunkPlan::kNone;
      met = {tile, found->second.depth, found->second.grid.data()};
    }
    const int shift = 16 - met.depth;
    const std::uint32_t x = static_cast<std::uint32_t>(place.x) >> shift, y = static_cast<std::uint32_t>(place.y) >> shift,
                        z = static_cast<std::uint32_t>(place.z) >> shift;
    return met.grid[(z << met.depth | y) << met.depth | x];
  }

 private:
  struct Met {
    glm::ivec3 tile{0};
    int depth = 0;
    const std::uint32_t* grid = nullptr;
  };
  const ChunkPlan& m_plan;
  std::array<Met, 64> m_met;
};

}  // namespace alidade
