// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/copc_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <fmt/format.h>

namespace alidade {

namespace {

constexpr std::size_t kEntry = 32;
constexpr int kDeepest = 30;
constexpr const char* kExportAgain = "The file is damaged: copy or export it again";

struct Page {
  std::uint64_t offset = 0, size = 0;
};

bool isInside(const OctreeCell& cell) {
  if (cell.depth < 0 || cell.depth > kDeepest) return false;
  const std::int64_t end = std::int64_t{1} << cell.depth;
  return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < end && cell.y < end && cell.z < end;
}

}  // namespace

Bounds CopcHierarchy::cubeOf(const OctreeCell& cell) const {
  const CopcInfo& info = *m_header.copc;
  const double edge = std::ldexp(2 * info.halfSize, -cell.depth);
  Bounds cube;
  cube.min = info.centre - info.halfSize + edge * glm::dvec3(cell.x, cell.y, cell.z);
  cube.max = cube.min + edge;
  return cube;
}

double CopcHierarchy::spacingOf(int depth) const {
  return std::ldexp(m_header.copc->spacing, -depth);
}

bool CopcHierarchy::matches(const OctreeCell& cell, const CopcQuery& query) const {
  if (cell.depth > query.deepest) return false;
  // A level is left out where the one above it is fine enough.
  if (cell.depth > 0 && query.finestSpacing > 0 && spacingOf(cell.depth - 1) <= query.finestSpacing) return false;
  if (query.region.empty()) return true;
  const Bounds cube = cubeOf(cell);
  return glm::all(glm::lessThanEqual(cube.min, query.region.max)) && glm::all(glm::lessThanEqual(query.region.min, cube.max));
}

Result<std::vector<CopcNode>> CopcHierarchy::nodes(const CopcQuery& query) const {
  const CopcInfo& info = *m_header.copc;
  std::vector<CopcNode> found;
  std::vector<Page> pages = {{info.rootOffset, info.rootSize}};
  std::set<std::uint64_t> seen;
  std::vector<std::byte> bytes;
  while (!pages.empty()) {
    const Page page = pages.back();
    pages.pop_back();
    const std::string where = fmt::format("{}, hierarchy page at byte {}", m_file.path(), page.offset);
    if (page.size % kEntry != 0 || page.offset > m_file.size() || page.size > m_file.size() - page.offset)
      return fail(fmt::format("A hierarchy page of {} bytes does not fit the file of {}", page.size, m_file.size()), where,
                  kExportAgain);
    if (!seen.insert(page.offset).second) return fail("The hierarchy's pages run in circles", where, kExportAgain);
    bytes.resize(page.size);
    if (auto ok = m_file.readAt(page.offset, bytes); !ok) return fail(ok.error());
    for (std::size_t at = 0; at < bytes.size(); at += kEntry) {
      const std::byte* entry = bytes.data() + at;
      const OctreeCell cell{lasValue<std::int32_t>(entry, 0), lasValue<std::int32_t>(entry, 4),
                            lasValue<std::int32_t>(entry, 8), lasValue<std::int32_t>(entry, 12)};
      const auto offset = lasValue<std::uint64_t>(entry, 16);
      const auto size = lasValue<std::int32_t>(entry, 24), count = lasValue<std::int32_t>(entry, 28);
      if (!isInside(cell)) return fail("The hierarchy names a cell outside of its cube", where, kExportAgain);
      if (count == 0 || !matches(cell, query)) continue;
      if (count < -1 || size < 0)
        return fail(fmt::format("A node of the hierarchy has {} points in {} bytes", count, size), where, kExportAgain);
      if (count == -1) {
        pages.push_back({offset, static_cast<std::uint64_t>(size)});
        continue;
      }
      if (offset < m_header.pointsOffset + 8 || offset > m_file.size() ||
          static_cast<std::uint64_t>(size) > m_file.size() - offset)
        return fail(fmt::format("A node's {} bytes at byte {} are not among the file's points", size, offset), where,
                    kExportAgain);
      found.push_back({cell, cubeOf(cell), spacingOf(cell.depth),
                       {offset, static_cast<std::uint64_t>(size), static_cast<std::uint64_t>(count)}});
    }
  }
  std::sort(found.begin(), found.end(), [](const CopcNode& a, const CopcNode& b) {
    return std::tie(a.cell.depth, a.run.offset) < std::tie(b.cell.depth, b.run.offset);
  });
  return found;
}

Result<std::vector<LasRun>> CopcHierarchy::coarsest(std::uint64_t wanted) const {
  // Level by level, so that a server is not asked for pages of levels that are not needed.
  std::vector<LasRun> runs;
  std::uint64_t points = 0;
  for (int depth = 0; depth <= kDeepest && points < wanted; ++depth) {
    auto found = nodes({{}, depth, 0});
    if (!found) return fail(found.error());
    std::erase_if(*found, [&](const CopcNode& node) { return node.cell.depth != depth; });
    std::uint64_t here = 0;
    for (const CopcNode& node : *found) here += node.run.count;
    if (here == 0 && points == m_header.pointCount) break;
    const double share = std::min(1.0, static_cast<double>(wanted - points) / static_cast<double>(std::max<std::uint64_t>(1, here)));
    for (const CopcNode& node : *found) {
      LasRun run = node.run;
      run.count = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(static_cast<double>(run.count) * share)));
      run.count = std::min(run.count, node.run.count);
      runs.push_back(run);
      points += run.count;
    }
  }
  return runs;
}

}  // namespace alidade
