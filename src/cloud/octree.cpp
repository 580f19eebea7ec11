// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "base/parallel.h"

namespace alidade {

namespace {

/// A leaf this small may be coarser than the wanted step: its step is still a tiny part of the
/// distance between its points, and sparse clouds do not dissolve into one node a point.
constexpr std::size_t kSparseLeaf = 16;

/// A run of items that becomes the node `node`.
struct Pending {
  std::size_t first = 0;
  std::size_t last = 0;
  std::uint32_t node = 0;
  double levelFrom = 0;
};

struct Split {
  std::array<std::size_t, 9> bound{};  ///< octant o is [bound[o], bound[o+1])
  double levelFrom = 0;
  bool split = false;
};

std::uint64_t spread(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

std::uint64_t gather(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
  v = (v | v >> 4) & 0x100f00f00f00f00full;
  v = (v | v >> 8) & 0x1f0000ff0000ffull;
  v = (v | v >> 16) & 0x1f00000000ffffull;
  return (v | v >> 32) & 0x1fffff;
}

/// Depth of the smallest cell that holds all keys of the run.
std::uint32_t commonDepth(std::span<const OctreeItem> run) {
  std::uint64_t differing = 0;
  for (const OctreeItem& item : run) differing |= item.key ^ run.front().key;
  if (differing == 0) return OctreeFrame::kBits;
  return static_cast<std::uint32_t>((62 - (63 - std::countl_zero(differing))) / 3);
}

/// American-flag partition of the run by the octant at `depth`.
std::array<std::size_t, 9> splitByOctant(std::span<OctreeItem> run, std::uint32_t depth) {
  const int shift = 60 - 3 * static_cast<int>(depth);
  const auto octantOf = [shift](const OctreeItem& item) { return (item.key >> shift) & 7; };
  std::array<std::size_t, 9> bound{};
  for (const OctreeItem& item : run) ++bound[octantOf(item) + 1];
  for (int o = 0; o < 8; ++o) bound[o + 1] += bound[o];
  std::array<std::size_t, 8> next;
  std::copy_n(bound.begin(), 8, next.begin());
  for (std::size_t o = 0; o < 8; ++o) {
    while (next[o] < bound[o + 1]) {
      const std::size_t home = octantOf(run[next[o]]);
      if (home == o) {
        ++next[o];
      } else {
        std::swap(run[next[o]], run[next[home]++]);
      }
    }
  }
  return bound;
}

class Builder {
 public:
  Builder(std::vector<OctreeItem>& items, const OctreeFrame& frame, const OctreeOptions& options)
      : m_items(items), m_frame(frame), m_options(options) {}

  Octree run(const Progress& progress) {
    m_tree.nodes.resize(1);
    m_tree.levels.resize(1);
    std::vector<Pending> generation{{0, m_items.size(), 0, 0.0}};
    std::size_t settled = 0;
    while (!generation.empty() && !progress.cancelled()) {
      std::vector<Split> splits(generation.size());
      parallelFor(generation.size(), 1, [&](std::size_t first, std::size_t last, int) {
        for (std::size_t i = first; i < last; ++i) splits[i] = settle(generation[i]);
      });
      for (const Pending& pending : generation) settled += m_tree.nodes[pending.node].count;
      generation = children(generation, splits);
      progress.report(static_cast<double>(settled) / static_cast<double>(m_items.size()), "Sorting points");
    }
    return std::move(m_tree);
  }

 private:
  /// Fills the node from its run: decides what it keeps, puts that first, sorted by level, and cuts
  /// the rest into octants.
  Split settle(const Pending& pending) {
    const std::span<OctreeItem> run(m_items.data() + pending.first, pending.last - pending.first);
    CloudNode& node = m_tree.nodes[pending.node];
    node.depth = pending.node == 0 ? 0 : commonDepth(run);
    node.size = m_frame.sizeAt(node.depth);
    node.step = node.size / 65536.0;
    node.origin = m_frame.cornerOf(run.front().key, node.depth) + 0.5 * node.step;
    node.first = pending.first;

    const bool fine = node.step <= m_options.finestStepMeters;
    const double deepest = m_options.deepestLevel + 1.0;
    const bool leaf = (run.size() <= m_options.leafPoints && (fine || run.size() <= kSparseLeaf)) ||
                      node.depth >= OctreeFrame::kBits;
    const double levelTo = leaf ? deepest : std::min(deepest, node.depth + 1.0);
    const std::size_t kept = leaf ? run.size() : fine ? keep(run, levelTo) : 0;
    node.count = static_cast<std::uint32_t>(kept);
    m_tree.levels[pending.node] = {pending.levelFrom, kept > 0 ? levelTo : pending.levelFrom};
    std::sort(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(kept),
              [](const OctreeItem& a, const OctreeItem& b) {
                return a.level != b.level ? a.level < b.level : a.index < b.index;
              });
    if (leaf) return {};
    Split split{splitByOctant(run.subspan(kept), node.depth), m_tree.levels[pending.node].to, true};
    for (std::size_t& bound : split.bound) bound += pending.first + kept;
    return split;
  }

  /// Moves what lies below `levelTo` to the front and returns how many; nothing where that is all,
  /// or too many for one node to be culled well.
  std::size_t keep(std::span<OctreeItem> run, double levelTo) const {
    const auto below = [levelTo](const OctreeItem& item) { return item.level < levelTo; };
    const auto count = static_cast<std::size_t>(std::count_if(run.begin(), run.end(), below));
    if (count == run.size() || count > 4 * static_cast<std::size_t>(m_options.leafPoints)) return 0;
    std::partition(run.begin(), run.end(), below);
    return count;
  }

  std::vector<Pending> children(const std::vector<Pending>& generation, const std::vector<Split>& splits) {
    std::vector<Pending> next;
    for (std::size_t i = 0; i < generation.size(); ++i) {
      if (!splits[i].split) continue;
      const auto firstChild = static_cast<std::int32_t>(m_tree.nodes.size() + next.size());
      CloudNode& parent = m_tree.nodes[generation[i].node];
      for (int o = 0; o < 8; ++o) {
        if (splits[i].bound[o] == splits[i].bound[o + 1]) continue;
        next.push_back({splits[i].bound[o], splits[i].bound[o + 1],
                        static_cast<std::uint32_t>(m_tree.nodes.size() + next.size()), splits[i].levelFrom});
        ++parent.childCount;
      }
      parent.firstChild = firstChild;
    }
    m_tree.nodes.resize(m_tree.nodes.size() + next.size());
    m_tree.levels.resize(m_tree.nodes.size());
    return next;
  }

  std::vector<OctreeItem>& m_items;
  const OctreeFrame& m_frame;
  const OctreeOptions& m_options;
  Octree m_tree;
};

}  // namespace

OctreeFrame OctreeFrame::around(const Bounds& bounds) {
  // The corner is snapped to the coarsest step that is at most a millimetre, the edge to a power of
  // two that still holds everything once snapped.
  constexpr double kSnap = 1.0 / 1024.0;
  OctreeFrame frame;
  const glm::dvec3 extent = bounds.size();
  const double largest = std::max({extent.x, extent.y, extent.z});
  frame.size = std::exp2(std::ceil(std::log2(std::max(largest + 2 * kSnap, 64 * kSnap))));
  frame.corner = glm::floor(bounds.min / kSnap) * kSnap;
  return frame;
}

std::uint64_t OctreeFrame::keyOf(const glm::dvec3& position) const {
  constexpr double kLast = (1 << kBits) - 1;
  const glm::dvec3 cell = glm::clamp(glm::floor((position - corner) * ((1 << kBits) / size)), 0.0, kLast);
  return spread(static_cast<std::uint64_t>(cell.x)) | spread(static_cast<std::uint64_t>(cell.y)) << 1 |
         spread(static_cast<std::uint64_t>(cell.z)) << 2;
}

double OctreeFrame::sizeAt(std::uint32_t depth) const {
  return std::ldexp(size, -static_cast<int>(depth));
}

glm::dvec3 OctreeFrame::cornerOf(std::uint64_t key, std::uint32_t depth) const {
  const int drop = kBits - static_cast<int>(depth);
  const auto cell = [drop](std::uint64_t bits) { return static_cast<double>(gather(bits) >> drop); };
  return corner + sizeAt(depth) * glm::dvec3(cell(key), cell(key >> 1), cell(key >> 2));
}

Octree buildOctree(std::vector<OctreeItem>& items, const OctreeFrame& frame, const OctreeOptions& options,
                   const Progress& progress) {
  if (items.empty()) return {};
  return Builder(items, frame, options).run(progress);
}

}  // namespace alidade
