// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What a B+-tree over the level (Zhang 2020) costs and brings beside nodes that are sorted by level.

#include <algorithm>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/site.h"

namespace alidade {
namespace {

constexpr std::size_t kMillions = 5;

/// A B+-tree of points by level, filled at once: leaves of kFanout entries side by side, inner nodes of as many keys.
class LevelTree {
 public:
  static constexpr std::size_t kFanout = 64;
  struct Entry {
    float level;
    std::uint32_t point;
  };

  explicit LevelTree(std::vector<Entry> entries) : m_leaves(std::move(entries)) {
    std::sort(m_leaves.begin(), m_leaves.end(), [](const Entry& a, const Entry& b) { return a.level != b.level ? a.level < b.level : a.point < b.point; });
    std::vector<float> keys;
    for (std::size_t i = 0; i < m_leaves.size(); i += kFanout) keys.push_back(m_leaves[i].level);
    while (keys.size() > 1) {
      std::vector<float> above;
      for (std::size_t i = 0; i < keys.size(); i += kFanout) above.push_back(keys[i]);
      m_inner.push_back(std::move(keys));
      keys = std::move(above);
    }
  }

  /// Calls visit(point) for all points below a level, from the coarsest on.
  template <class Visit>
  void forEachBelow(float level, const Visit& visit) const {
    std::size_t node = 0;
    for (std::size_t depth = m_inner.size(); depth-- > 0;) {
      const auto& keys = m_inner[depth];
      const auto first = keys.begin() + static_cast<std::ptrdiff_t>(node * kFanout);
      const auto last = keys.begin() + static_cast<std::ptrdiff_t>(std::min(keys.size(), (node + 1) * kFanout));
      const auto above = std::lower_bound(first, last, level);
      node = static_cast<std::size_t>(above - keys.begin()) - (above > first ? 1 : 0);
    }
    const std::size_t end = std::min(m_leaves.size(), (node + 1) * kFanout);
    for (std::size_t i = 0; i < end && m_leaves[i].level < level; ++i) visit(m_leaves[i].point);
  }

  std::size_t bytes() const {
    std::size_t all = m_leaves.size() * sizeof(Entry);
    for (const auto& keys : m_inner) all += keys.size() * sizeof(float);
    return all;
  }

 private:
  std::vector<Entry> m_leaves;
  std::vector<std::vector<float>> m_inner;  ///< from the one above the leaves
};

LevelTree treeOf(const PointStore& store) {
  std::vector<LevelTree::Entry> entries;
  for (std::uint32_t n = 0; n < store.nodes().size(); ++n) {
    const NodeLevels levels = store.levelsOf(n);
    std::uint32_t p = 0;
    for (std::size_t i = 0; i < levels.cumulative.size(); ++i)
      for (; p < levels.cumulative[i]; ++p)
        entries.push_back({(static_cast<float>(levels.firstStep) + static_cast<float>(i)) / kLevelSteps, static_cast<std::uint32_t>(store.nodes()[n].first + p)});
  }
  return LevelTree(std::move(entries));
}

/// Stands for drawing: looks at every point.
std::uint64_t look(const DisplayPoint& p) {
  return static_cast<std::uint64_t>(p.x) + p.y + p.z + p.rgb565;
}

/// A quarter of the points, by each node's sorted prefix.
void levels_by_prefix_5M(benchmark::State& state) {
  const auto store = test::siteOf(kMillions * 1'000'000);
  const double level = store->levelOfShare(0.25);
  std::uint64_t points = 0, sum = 0;
  for (auto _ : state) {
    points = 0;
    for (std::uint32_t n = 0; n < store->nodes().size(); ++n) {
      const std::uint32_t count = store->countBelow(n, level);
      for (const DisplayPoint& p : store->points().subspan(store->nodes()[n].first, count)) sum += look(p);
      points += count;
    }
    benchmark::DoNotOptimize(sum);
  }
  std::size_t tables = 0;
  for (std::uint32_t n = 0; n < store->nodes().size(); ++n) tables += store->levelsOf(n).cumulative.size_bytes();
  state.counters["bytes_per_point"] = static_cast<double>(tables) / static_cast<double>(store->pointCount());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points));
}

/// The same quarter, by a B+-tree over the level of all points.
void levels_by_tree_5M(benchmark::State& state) {
  const auto store = test::siteOf(kMillions * 1'000'000);
  const LevelTree tree = treeOf(*store);
  const auto level = static_cast<float>(store->levelOfShare(0.25));
  std::uint64_t points = 0, sum = 0;
  for (auto _ : state) {
    points = 0;
    tree.forEachBelow(level, [&](std::uint32_t p) { sum += look(store->points()[p]), ++points; });
    benchmark::DoNotOptimize(sum);
  }
  state.counters["bytes_per_point"] = static_cast<double>(tree.bytes()) / static_cast<double>(store->pointCount());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points));
}

BENCHMARK(levels_by_prefix_5M)->Unit(benchmark::kMillisecond);
BENCHMARK(levels_by_tree_5M)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace alidade
