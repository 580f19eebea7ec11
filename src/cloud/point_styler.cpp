// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_styler.h"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "cloud/point_painting.h"

namespace alidade {

namespace {

constexpr std::uint32_t kBlock = 256;
constexpr std::size_t kKeptPoints = std::size_t{1} << 26;

/// What is styled of one node: copies of those of its first `done` points that the filter leaves.
struct StyledNode {
  std::vector<DisplayPoint> points;
  std::vector<std::uint32_t> places;       ///< in the node of each copy; empty where all are left
  std::vector<std::uint32_t> leftAtBlock;  ///< copies made of the blocks before; empty where all are left
  std::uint32_t done = 0;
  std::uint64_t usedAt = 0;
};

}  // namespace

struct PointStyler::Impl {
  ScanPoints scan;

  /// The styles are kept apart: what is shown and what hides the design alternate within a frame.
  struct Kept {
    std::optional<PointStyle> style;
    glm::dvec3 eye{0};
    std::unordered_map<std::uint32_t, StyledNode> nodes;
    std::uint64_t frame = 0;
  };
  Kept kept[2];

  void prepare(Kept& cache, const PointStyle& style, Part part, const glm::dvec3& eye) const {
    const bool byEye = part == Part::ColourAndFilter && style.colourBy == ColourBy::Distance;
    if (cache.style != style || (byEye && cache.eye != eye)) cache.nodes.clear();
    cache.style = style;
    cache.eye = eye;
    ++cache.frame;
    std::size_t points = 0;
    for (const auto& [index, node] : cache.nodes) points += node.points.capacity();
    if (points > kKeptPoints) std::erase_if(cache.nodes, [&](const auto& entry) { return entry.second.usedAt + 1 < cache.frame; });
  }

  /// Styles the node's points up to `count`, whole blocks at a time.
  void extend(StyledNode& styled, const CloudNode& node, std::uint32_t count, const PointFilter& filter,
              const PointColours* colours) const {
    const bool all = filter.of(node) == PointFilter::Verdict::All;
    const auto wanted = std::min((count + kBlock - 1) / kBlock * kBlock, node.count);
    std::uint8_t keep[kBlock];
    std::uint16_t colour[kBlock];
    while (styled.done < wanted) {
      const std::uint32_t size = std::min(kBlock, node.count - styled.done);
      const std::uint64_t first = node.first + styled.done;
      const DisplayPoint* from = scan.store->points().data() + first;
      if (!all) {
        styled.leftAtBlock.push_back(static_cast<std::uint32_t>(styled.points.size()));
        filter.keep(node, first, size, keep);
      }
      if (colours) colours->colours(node, first, size, colour);
      for (std::uint32_t i = 0; i < size; ++i) {
        if (!all && !keep[i]) continue;
        styled.points.push_back(from[i]);
        if (!all) styled.places.push_back(styled.done + i);
        if (colours) styled.points.back().rgb565 = colour[i];
      }
      styled.done += size;
    }
  }

  /// How many copies stand for the node's first `count` points.
  std::uint32_t copiesFor(const StyledNode& styled, const CloudNode& node, std::uint32_t count,
                          const PointFilter& filter) const {
    if (styled.leftAtBlock.empty()) return count;
    if (count >= styled.done) return static_cast<std::uint32_t>(styled.points.size());
    const std::uint32_t block = count / kBlock, rest = count % kBlock;
    std::uint32_t left = styled.leftAtBlock[block];
    std::uint8_t keep[kBlock];
    filter.keep(node, node.first + block * kBlock, rest, keep);
    for (std::uint32_t i = 0; i < rest; ++i) left += keep[i];
    return left;
  }
};

PointStyler::PointStyler(ScanPoints scan) : m_impl(std::make_unique<Impl>()) {
  m_impl->scan = std::move(scan);
}

PointStyler::~PointStyler() = default;

void PointStyler::apply(const PointStyle& style, Part part, const glm::dvec3& eye, Selection& selection) {
  const PointStore& store = *m_impl->scan.store;
  const PointFilter filter(store, style);
  const PointColours colouring(m_impl->scan, style, eye);
  const PointColours* colours = part == Part::ColourAndFilter && colouring.changesAny() ? &colouring : nullptr;
  if (!filter.filtersAny() && !colours) return;

  Impl::Kept& cache = m_impl->kept[part == Part::Filter ? 1 : 0];
  m_impl->prepare(cache, style, part, eye);
  // Entries are made first: the map must not grow while threads hold its nodes.
  std::vector<StyledNode*> styled;
  for (const SelectedRange& range : selection.ranges) {
    styled.push_back(&cache.nodes[range.node]);
    styled.back()->usedAt = cache.frame;
  }
  parallelFor(selection.ranges.size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      SelectedRange& range = selection.ranges[i];
      const CloudNode& node = store.nodes()[range.node];
      const PointFilter::Verdict verdict = filter.of(node);
      if (verdict == PointFilter::Verdict::None) range.count = 0;
      if (verdict == PointFilter::Verdict::None || (verdict == PointFilter::Verdict::All && !colours)) continue;
      m_impl->extend(*styled[i], node, range.count, filter, colours);
      range.count = m_impl->copiesFor(*styled[i], node, range.count, filter);
      range.styled = styled[i]->points.data();
      range.places = styled[i]->places.empty() ? nullptr : styled[i]->places.data();
    }
  });
  std::erase_if(selection.ranges, [](const SelectedRange& range) { return range.count == 0; });
  selection.pointCount = 0;
  for (const SelectedRange& range : selection.ranges) selection.pointCount += range.count;
}

}  // namespace alidade
