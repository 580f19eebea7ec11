// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_store.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "base/parallel.h"
#include "cloud/octree.h"
#include "cloud/source_columns.h"
#include "cloud/spacing.h"

namespace alidade {

namespace {

/// Sebastiano Vigna's SplitMix64 (public domain algorithm): a counter-based draw, so that a point's
/// level depends on the seed and its place in the source alone, not on threads or batches.
double uniformOf(std::uint32_t seed, std::uint64_t index) {
  std::uint64_t z = (static_cast<std::uint64_t>(seed) << 32) + (index + 1) * 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-53;
}

/// The level as stored: below L+1 even once rounded to float.
float storedLevel(const LevelLaw& law, double u) {
  const auto top = std::nextafter(static_cast<float>(law.deepest + 1), 0.0f);
  return std::min(static_cast<float>(law.levelOfUniform(u)), top);
}

class MemoryPointStore : public PointStore {
 public:
  std::uint64_t pointCount() const override { return m_points.size(); }
  const Bounds& bounds() const override { return m_source.bounds(); }
  const LevelLaw& levelLaw() const override { return m_law; }
  std::span<const CloudNode> nodes() const override { return m_nodes; }
  std::span<const DisplayPoint> points() const override { return m_points; }
  std::span<const float> levels() const override { return m_levels; }
  double medianSpacing() const override { return m_medianSpacing; }
  glm::dvec3 sourcePosition(std::uint64_t point) const override {
    return m_source.position(m_sourceIndex[point]);
  }
  std::uint64_t sourceIndex(std::uint64_t point) const override { return m_sourceIndex[point]; }
  std::optional<glm::u8vec3> sourceColour(std::uint64_t point) const override {
    return m_source.colour(m_sourceIndex[point]);
  }

  SourceColumns m_source;
  LevelLaw m_law;
  std::vector<CloudNode> m_nodes;
  std::vector<DisplayPoint> m_points;
  std::vector<float> m_levels;
  std::vector<std::uint32_t> m_sourceIndex;
  double m_medianSpacing = 0;
};

DisplayPoint displayPoint(const CloudNode& node, const glm::dvec3& position, std::uint16_t colour) {
  const glm::dvec3 steps = glm::clamp(glm::round((position - node.origin) / node.step), 0.0, 65535.0);
  return {static_cast<std::uint16_t>(steps.x), static_cast<std::uint16_t>(steps.y),
          static_cast<std::uint16_t>(steps.z), colour};
}

std::vector<OctreeItem> itemsOf(const SourceColumns& source, const OctreeFrame& frame, const LevelLaw& law,
                                std::uint32_t seed) {
  std::vector<OctreeItem> items(source.size() - source.droppedCount());
  if (source.droppedCount() > 0) {
    std::size_t next = 0;
    for (std::uint64_t i = 0; i < source.size(); ++i) {
      if (SourceColumns::isUsable(source.position(i))) items[next++].index = static_cast<std::uint32_t>(i);
    }
  }
  const bool gaps = source.droppedCount() > 0;
  parallelFor(items.size(), 1 << 16, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      const std::uint64_t index = gaps ? items[i].index : i;
      items[i] = {frame.keyOf(source.position(index)), storedLevel(law, uniformOf(seed, index)),
                  static_cast<std::uint32_t>(index)};
    }
  });
  return items;
}

/// Display points, levels and source indices in the order of `items`; the nodes' own bounds.
void fillColumns(MemoryPointStore& store, const std::vector<OctreeItem>& items) {
  store.m_points.resize(items.size());
  store.m_levels.resize(items.size());
  store.m_sourceIndex.resize(items.size());
  parallelFor(store.m_nodes.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t n = first; n < last; ++n) {
      CloudNode& node = store.m_nodes[n];
      for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
        const glm::dvec3& position = store.m_source.position(items[i].index);
        node.bounds.add(position);
        store.m_points[i] = displayPoint(node, position, store.m_source.displayColour(items[i].index));
        store.m_levels[i] = items[i].level;
        store.m_sourceIndex[i] = items[i].index;
      }
    }
  });
  for (std::size_t n = store.m_nodes.size(); n-- > 0;) {
    CloudNode& node = store.m_nodes[n];
    for (std::uint32_t c = 0; c < node.childCount; ++c) {
      node.bounds.add(store.m_nodes[static_cast<std::size_t>(node.firstChild) + c].bounds);
    }
  }
}

}  // namespace

struct PointStoreBuilder::Impl {
  Options options;
  SourceColumns source;

  Result<std::shared_ptr<const PointStore>> build(const Progress& progress) {
    const std::uint64_t count = source.size() - source.droppedCount();
    if (source.size() >= std::numeric_limits<std::uint32_t>::max()) {
      return fail("The cloud has more points than a store in memory can hold",
                  std::to_string(count) + " points", "Open it in parts of fewer than 4 billion points");
    }
    auto store = std::make_shared<MemoryPointStore>();
    store->m_law = LevelLaw::forPointCount(count, options.dimensions);
    store->m_source = std::move(source);
    source = SourceColumns();
    if (count == 0) return std::shared_ptr<const PointStore>(std::move(store));

    progress.report(0.0, "Drawing levels");
    const OctreeFrame frame = OctreeFrame::around(store->m_source.bounds());
    std::vector<OctreeItem> items = itemsOf(store->m_source, frame, store->m_law, options.seed);
    if (progress.cancelled()) return fail(cancelledError());

    OctreeOptions octreeOptions;
    octreeOptions.leafPoints = std::max(1u, options.leafPoints);
    octreeOptions.deepestLevel = store->m_law.deepest;
    Octree tree = buildOctree(items, frame, octreeOptions, progress.part(0.2, 0.7));
    if (progress.cancelled()) return fail(cancelledError());

    progress.report(0.7, "Packing points");
    store->m_nodes = std::move(tree.nodes);
    fillColumns(*store, items);
    items = {};
    if (progress.cancelled()) return fail(cancelledError());

    progress.report(0.9, "Measuring point spacing");
    store->m_medianSpacing = measureSpacing(store->m_nodes, tree.levels, store->m_points, store->m_law);
    progress.report(1.0, "Points ready");
    return std::shared_ptr<const PointStore>(std::move(store));
  }
};

PointStoreBuilder::PointStoreBuilder() : PointStoreBuilder(Options{}) {}
PointStoreBuilder::PointStoreBuilder(const Options& options) : m_impl(std::make_unique<Impl>()) {
  m_impl->options = options;
}
PointStoreBuilder::~PointStoreBuilder() = default;

void PointStoreBuilder::add(const PointBatch& batch) {
  m_impl->source.add(batch);
}

std::uint64_t PointStoreBuilder::droppedCount() const {
  return m_impl->source.droppedCount();
}

Result<std::shared_ptr<const PointStore>> PointStoreBuilder::build(const Progress& progress) {
  try {
    return m_impl->build(progress);
  } catch (const std::bad_alloc&) {
    return fail("There is not enough memory for the cloud's points", {},
                "Close other data or open a thinned version of the cloud");
  }
}

}  // namespace alidade
