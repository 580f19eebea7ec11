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
///
/// A tile is named by its key, 21 bits an axis, x lowest; a place in it by 16 bits an axis, x lowest, and whatever above.
class CellFinder {
 public:
  explicit CellFinder(const ChunkPlan& plan) : m_plan(plan) {}

  static glm::ivec3 tileOfKey(std::uint64_t key) {
    const auto part = [key](int shift) { return static_cast<std::int32_t>(key >> shift << 43 >> 32) >> 11; };
    return {part(0), part(21), part(42)};
  }

  /// The cell that holds each place of each tile, or ChunkPlan::kNone for a tile that the sample did not meet.
  void find(const std::uint64_t* tiles, const std::uint64_t* places, std::size_t count, std::uint32_t* cells);

  struct Met {
    std::uint64_t tile = ~std::uint64_t{0};
    int depth = 0;
    const std::uint32_t* grid = nullptr;
  };

 private:
  const ChunkPlan& m_plan;
  std::array<Met, 64> m_met;
};

}  // namespace alidade
