// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/tree_join.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "cloud/morton.h"

namespace alidade {

namespace {

/// A node of one of the parts: of the tiles' common tree (tiles [a, b)), of a tile's top, or of a cell.
struct Ref {
  enum class Kind { Tiles, Top, Cell } kind = Kind::Tiles;
  std::size_t tile = 0;    ///< Tiles: the first
  std::size_t last = 0;    ///< Tiles: beyond the last
  std::size_t cell = 0, node = 0;
};

class Joiner {
 public:
  explicit Joiner(const std::vector<TileTree>& tiles) : m_tiles(tiles) {
    glm::ivec3 low = tiles[0].tile;
    for (const TileTree& tile : tiles) low = glm::min(low, tile.tile);
    m_low = low;
    for (const TileTree& tile : tiles) {
      const glm::ivec3 at = tile.tile - low;
      m_codes.push_back(mortonOf(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y), static_cast<std::uint32_t>(at.z)));
    }
    // Morton order about the middle of the world may differ from that about the lowest tile.
    m_order.resize(tiles.size());
    for (std::size_t i = 0; i < tiles.size(); ++i) m_order[i] = i;
    std::sort(m_order.begin(), m_order.end(), [&](std::size_t a, std::size_t b) { return m_codes[a] < m_codes[b]; });
  }

  std::vector<BuildNode> run() {
    std::vector<BuildNode> nodes;
    std::vector<Ref> refs;
    if (const auto root = resolved({Ref::Kind::Tiles, 0, m_order.size(), 0, 0})) refs.push_back(*root);
    for (std::size_t i = 0; i < refs.size(); ++i) {
      std::vector<Ref> children;
      BuildNode node = nodeOf(refs[i], children);
      node.firstChild = children.empty() ? -1 : static_cast<std::int32_t>(refs.size());
      node.childCount = static_cast<std::uint32_t>(children.size());
      refs.insert(refs.end(), children.begin(), children.end());
      nodes.push_back(node);
    }
    sumUp(nodes);
    return nodes;
  }

 private:
  /// What a reference stands for in the end; nothing where there are no points below it.
  std::optional<Ref> resolved(Ref ref) const {
    if (ref.kind == Ref::Kind::Tiles && ref.last - ref.tile == 1) {
      const std::size_t tile = m_order[ref.tile];
      ref = m_tiles[tile].top.empty() ? Ref{Ref::Kind::Cell, tile, 0, 0, 0} : Ref{Ref::Kind::Top, tile, 0, 0, 0};
    }
    if (ref.kind == Ref::Kind::Top) {
      const BuildNode& node = m_tiles[ref.tile].top[ref.node];
      if (node.firstChild < -1 || (node.firstChild == -1 && node.childCount == 1))
        ref = {Ref::Kind::Cell, ref.tile, 0, static_cast<std::size_t>(-1 - node.firstChild), 0};
    }
    if (ref.kind == Ref::Kind::Cell && m_tiles[ref.tile].cells[ref.cell].empty()) return std::nullopt;
    return ref;
  }

  BuildNode nodeOf(const Ref& ref, std::vector<Ref>& children) const {
    const auto add = [&](const Ref& child) {
      if (const auto found = resolved(child)) children.push_back(*found);
    };
    if (ref.kind != Ref::Kind::Tiles) {
      const std::vector<BuildNode>& nodes = ref.kind == Ref::Kind::Top ? m_tiles[ref.tile].top : m_tiles[ref.tile].cells[ref.cell];
      const BuildNode& node = nodes[ref.node];
      for (std::uint32_t c = 0; c < node.childCount; ++c)
        add({ref.kind, ref.tile, 0, ref.cell, static_cast<std::size_t>(node.firstChild) + c});
      return node;
    }
    const std::uint64_t differing = m_codes[m_order[ref.tile]] ^ m_codes[m_order[ref.last - 1]];
    const int bit = (63 - std::countl_zero(differing)) / 3;
    BuildNode node;
    node.depth = -(bit + 1);
    const std::uint64_t code = m_codes[m_order[ref.tile]] >> 3 * (bit + 1) << 3 * (bit + 1);
    node.tile = m_low + glm::ivec3(static_cast<std::int32_t>(gatherBits(code)), static_cast<std::int32_t>(gatherBits(code >> 1)),
                                   static_cast<std::int32_t>(gatherBits(code >> 2)));
    const auto octantOf = [&](std::size_t i) { return m_codes[m_order[i]] >> 3 * bit & 7; };
    for (std::size_t from = ref.tile; from < ref.last;) {
      std::size_t to = from;
      while (to < ref.last && octantOf(to) == octantOf(from)) ++to;
      add({Ref::Kind::Tiles, from, to, 0, 0});
      from = to;
    }
    return node;
  }

  const std::vector<TileTree>& m_tiles;
  glm::ivec3 m_low{0};
  std::vector<std::uint64_t> m_codes;
  std::vector<std::size_t> m_order;
};

}  // namespace

std::vector<BuildNode> joinTrees(const std::vector<TileTree>& tiles) {
  if (tiles.empty()) return {};
  return Joiner(tiles).run();
}

}  // namespace alidade
