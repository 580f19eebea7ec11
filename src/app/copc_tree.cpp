// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/copc_tree.h"

#include <algorithm>
#include <cmath>

namespace alidade {

namespace {

constexpr std::uint64_t kBatch = 100'000;
constexpr int kDeepest = 30;

/// Counts in the store's units from the root cube's corner. A node's cube is told by any of its points, exactly: nodes of one tile
/// share its corner.
class NodeCells {
 public:
  explicit NodeCells(const PointStore& store) : m_store(store), m_root(store.nodes()[0]) {
    m_rootBits = static_cast<int>(std::lround(std::log2(m_root.size / m_root.step)));
    for (const CloudNode& node : store.nodes())
      if (node.count > 0) {
        m_corner = (unitOf(node) >> std::int64_t{m_rootBits}) << std::int64_t{m_rootBits};
        break;
      }
  }

  /// Half a unit before the corner: a source point may lie up to that far from its unit.
  glm::dvec3 corner() const { return m_root.origin + (glm::dvec3(m_corner) - 0.5) * m_root.step; }

  OctreeCell of(const CloudNode& node) const {
    const std::int64_t bits = m_rootBits - static_cast<int>(node.depth);
    const glm::i64vec3 at = (unitOf(node) - m_corner) >> std::max(bits, std::int64_t{0});
    return {static_cast<int>(node.depth), static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y), static_cast<std::int32_t>(at.z)};
  }

  /// Cubes smaller than a unit cannot be told apart.
  int deepest() const { return std::min(m_rootBits, kDeepest); }

 private:
  glm::i64vec3 unitOf(const CloudNode& node) const {
    const DisplayPoint& p = m_store.points()[node.first];
    return glm::i64vec3(glm::round((node.origin - m_root.origin) / m_root.step)) + glm::i64vec3(p.x, p.y, p.z);
  }

  const PointStore& m_store;
  const CloudNode& m_root;
  int m_rootBits = 0;
  glm::i64vec3 m_corner{0};
};

/// A node at the store's depth d holds levels [d, d + 1), and level l has 64 · 2^l points along a tile (blue_noise.h).
constexpr double kPointsAlong = 128;

}  // namespace

Result<std::vector<std::string>> writeTree(const PointStore& store, const ScanInfo& info, const ScanNotes& notes, const ScanWriter& writer,
                                           const std::string& path, const Progress& progress) {
  if (store.pointCount() == 0) return fail("There are no points to make a tree of", path, "Write an empty scan as LAS or LAZ");
  const NodeCells cells(store);
  ScanWriteOptions options;
  options.info = info;
  options.info.bounds = store.bounds();
  options.notes = notes;
  options.cubeCorner = cells.corner();
  options.cubeSize = store.nodes()[0].size;
  options.rootSpacing = options.cubeSize / kPointsAlong;
  for (const CloudNode& node : store.nodes())
    if (node.count > 0 && static_cast<int>(node.depth) > cells.deepest())
      return fail("The store's tree is deeper than COPC counts", path, "Write it as LAZ");
  auto sink = writer.create(path, options);
  if (!sink) return fail(sink.error());
  std::uint64_t done = 0;
  for (const CloudNode& node : store.nodes()) {
    for (std::uint64_t first = 0; first < node.count; first += kBatch) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(static_cast<double>(done) / static_cast<double>(store.pointCount()), "Writing the octree");
      const std::uint64_t count = std::min<std::uint64_t>(kBatch, node.count - first);
      if (auto ok = (*sink)->add(store.batch(node.first + first, count), cells.of(node)); !ok) return fail(ok.error());
      done += count;
    }
  }
  if (auto ok = (*sink)->finish(); !ok) return fail(ok.error());
  return (*sink)->remarks();
}

}  // namespace alidade
