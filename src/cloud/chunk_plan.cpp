// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/chunk_plan.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/widest.h"
#include "cloud/morton.h"
#include "cloud/key_sort.h"
#include "cloud/raw_bytes.h"

namespace alidade {

namespace {

constexpr int kDeepestCell = 7;

/// Tiles are counted in 20 bits and a sign (lattice.h).
std::uint64_t tileCode(const glm::ivec3& tile) {
  constexpr std::int32_t kMiddle = 1 << 20;
  return mortonOf(static_cast<std::uint32_t>(tile.x + kMiddle), static_cast<std::uint32_t>(tile.y + kMiddle),
                  static_cast<std::uint32_t>(tile.z + kMiddle));
}

glm::ivec3 tileOfCode(std::uint64_t code) {
  constexpr std::int32_t kMiddle = 1 << 20;
  return {static_cast<std::int32_t>(gatherBits(code)) - kMiddle, static_cast<std::int32_t>(gatherBits(code >> 1)) - kMiddle,
          static_cast<std::int32_t>(gatherBits(code >> 2)) - kMiddle};
}

std::uint64_t cellCode(const PlanCell& c) {
  return mortonOf(c.cell.x, c.cell.y, c.cell.z) << 3 * (16 - c.depth);
}

std::size_t slotOf(std::uint64_t tile) {
  return (tile & 3) | (tile >> 21 & 3) << 2 | (tile >> 42 & 3) << 4;
}

/// As far as tiles are known: how many places that is.
ALIDADE_WIDEST std::size_t findKnown(const CellFinder::Met* met, const std::uint64_t* tiles, const std::uint64_t* places, std::size_t count,
                                     std::uint32_t* cells) {
  for (std::size_t i = 0; i < count; ++i) {
    const CellFinder::Met& tile = met[slotOf(tiles[i])];
    if (tile.tile != tiles[i]) return i;
    const int depth = tile.depth, drop = 16 - depth;
    const std::uint64_t place = places[i], x = (place & 0xffff) >> drop, y = (place >> 16 & 0xffff) >> drop, z = (place >> 32 & 0xffff) >> drop;
    cells[i] = tile.grid[(z << depth | y) << depth | x];
  }
  return count;
}

}  // namespace

bool mortonLess(const PlanCell& a, const PlanCell& b) {
  const std::uint64_t tileA = tileCode(a.tile), tileB = tileCode(b.tile);
  return tileA != tileB ? tileA < tileB : cellCode(a) < cellCode(b);
}

ChunkPlan::ChunkPlan(std::span<const glm::i64vec3> sample, std::uint64_t pointCount, std::uint64_t cellPoints) {
  std::map<std::uint64_t, RawVector<std::uint64_t>> tiles;  // Morton codes inside each, by its own
  std::array<std::pair<glm::ivec3, RawVector<std::uint64_t>*>, 64> met{};  // a scan's order comes back to its tiles
  for (const glm::i64vec3& unit : sample) {
    const glm::i64vec3 in = unit & std::int64_t{0xffff};
    const glm::ivec3 tile(unit >> std::int64_t{16});
    auto& [its, codes] = met[static_cast<std::size_t>((tile.x & 3) | (tile.y & 3) << 2 | (tile.z & 3) << 4)];
    if (codes == nullptr || its != tile) its = tile, codes = &tiles[tileCode(tile)];
    codes->push_back(mortonOf(static_cast<std::uint64_t>(in.x), static_cast<std::uint64_t>(in.y), static_cast<std::uint64_t>(in.z)));
  }
  const double each = sample.empty() ? 1.0 : static_cast<double>(std::max<std::uint64_t>(pointCount, sample.size())) / static_cast<double>(sample.size());

  std::vector<double> expected;  // points a cell
  using Codes = std::span<const std::uint64_t>;
  const auto cut = [&](const auto& self, const glm::ivec3& tile, std::uint64_t code, int depth, Codes codes) -> void {
    const double points = each * static_cast<double>(codes.size());
    if (points <= static_cast<double>(cellPoints) || depth == kDeepestCell) {
      PlanCell cell{tile, static_cast<std::uint8_t>(depth), {}};
      const std::uint64_t at = code >> 3 * (16 - depth);
      cell.cell = {static_cast<std::uint16_t>(gatherBits(at)), static_cast<std::uint16_t>(gatherBits(at >> 1)),
                   static_cast<std::uint16_t>(gatherBits(at >> 2))};
      m_cells.push_back(cell);
      expected.push_back(points);
      return;
    }
    for (std::uint64_t octant = 0; octant < 8; ++octant) {
      const std::uint64_t from = code + (octant << 3 * (15 - depth)), to = from + (std::uint64_t{1} << 3 * (15 - depth));
      const auto low = std::lower_bound(codes.begin(), codes.end(), from), high = std::lower_bound(low, codes.end(), to);
      self(self, tile, from, depth + 1, Codes(low, high));
    }
  };
  for (auto& [code, codes] : tiles) {
    sortKeys(codes);
    const std::size_t firstCell = m_cells.size();
    const glm::ivec3 tile = tileOfCode(code);
    cut(cut, tile, 0, 0, codes);
    TileGrid grid;
    for (std::size_t c = firstCell; c < m_cells.size(); ++c) grid.depth = std::max<int>(grid.depth, m_cells[c].depth);
    grid.grid.resize(std::size_t{1} << 3 * grid.depth);
    for (std::size_t c = firstCell; c < m_cells.size(); ++c) {
      const int spread = grid.depth - m_cells[c].depth;
      const glm::uvec3 from = glm::uvec3(m_cells[c].cell) << glm::uvec3(static_cast<unsigned>(spread));
      const std::uint32_t side = 1u << spread;
      for (std::uint32_t z = from.z; z < from.z + side; ++z)
        for (std::uint32_t y = from.y; y < from.y + side; ++y)
          for (std::uint32_t x = from.x; x < from.x + side; ++x)
            grid.grid[(z << grid.depth | y) << grid.depth | x] = static_cast<std::uint32_t>(c);
    }
    m_tiles.emplace(tile, std::move(grid));
  }
  double inStream = 0;
  for (std::size_t c = 0; c < m_cells.size(); ++c) {
    if (c > 0 && inStream + expected[c] > static_cast<double>(cellPoints)) ++m_streamCount, inStream = 0;
    m_streams.push_back(m_streamCount);
    inStream += expected[c];
  }
  if (!m_cells.empty()) ++m_streamCount;
}

void CellFinder::find(const std::uint64_t* tiles, const std::uint64_t* places, std::size_t count, std::uint32_t* cells) {
  for (std::size_t i = 0; (i += findKnown(m_met.data(), tiles + i, places + i, count - i, cells + i)) < count;) {
    const auto found = m_plan.m_tiles.find(tileOfKey(tiles[i]));
    if (found == m_plan.m_tiles.end()) cells[i++] = ChunkPlan::kNone;
    else m_met[slotOf(tiles[i])] = {tiles[i], found->second.depth, found->second.grid.data()};
  }
}

}  // namespace alidade
