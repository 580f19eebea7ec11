// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/cleaning.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "geometry/bounds.h"

namespace alidade {

Result<KeepMask> thinByVoxel(std::span<const glm::dvec3> points, double edgeMeters, const Progress& progress) {
  if (!(edgeMeters > 0) || !std::isfinite(edgeMeters))
    return fail(fmt::format("A voxel cannot have an edge of {} m", edgeMeters), {}, "Give a length above 0");
  if (points.size() >= UINT32_MAX) return fail("The cloud has more points than can be thinned at once", {}, "Thin its scans one by one");
  Bounds bounds;
  for (const glm::dvec3& p : points) bounds.add(p);
  // Three numbers of 21 bits name a voxel.
  const glm::dvec3 cells = bounds.size() / edgeMeters;
  if (std::max({cells.x, cells.y, cells.z}) >= double(1 << 21))
    return fail(fmt::format("Voxels of {} m are too small for a cloud of {:.0f} m", edgeMeters, std::max({bounds.size().x, bounds.size().y, bounds.size().z})), {}, "Give a longer edge");
  struct Entry {
    std::uint64_t voxel;
    std::uint32_t point;
  };
  std::vector<Entry> entries(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 cell = glm::floor((points[i] - bounds.min) / edgeMeters);
    entries[i] = {std::uint64_t(cell.z) << 42 | std::uint64_t(cell.y) << 21 | std::uint64_t(cell.x), static_cast<std::uint32_t>(i)};
  }
  progress.report(0.2, "Thinning");
  if (progress.cancelled()) return fail(cancelledError());
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.voxel != b.voxel ? a.voxel < b.voxel : a.point < b.point; });
  progress.report(0.8, "Thinning");
  KeepMask keep(points.size(), 0);
  for (std::size_t first = 0; first < entries.size();) {
    std::size_t last = first;
    glm::dvec3 sum(0);
    for (; last < entries.size() && entries[last].voxel == entries[first].voxel; ++last) sum += points[entries[last].point] - bounds.min;
    const glm::dvec3 mean = bounds.min + sum / static_cast<double>(last - first);
    const auto nearest = std::min_element(entries.begin() + static_cast<std::ptrdiff_t>(first), entries.begin() + static_cast<std::ptrdiff_t>(last),
                                          [&](const Entry& a, const Entry& b) {
                                            return glm::distance(points[a.point], mean) < glm::distance(points[b.point], mean);
                                          });
    keep[nearest->point] = 1;
    first = last;
  }
  progress.report(1.0, "Thinning");
  return keep;
}

}  // namespace alidade
