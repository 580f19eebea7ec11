// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/tile_search.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <optional>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr std::size_t kTilePoints = 200000;

}  // namespace

pcl::PointCloud<pcl::PointXYZ>::Ptr pclCloud(std::span<const glm::dvec3> points, std::span<const std::uint32_t> index, const glm::dvec3& origin) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->points.reserve(index.size());
  for (const std::uint32_t i : index) {
    const glm::vec3 p(points[i] - origin);
    cloud->points.emplace_back(p.x, p.y, p.z);
  }
  cloud->width = static_cast<std::uint32_t>(cloud->points.size());
  cloud->height = 1;
  return cloud;
}

double typicalReach(std::span<const glm::dvec3> points, int neighbours) {
  Bounds bounds;
  for (const glm::dvec3& p : points) bounds.add(p);
  const glm::dvec3 size = bounds.size();
  // Scans are surfaces: as if spread over the largest face, four times as far for what is sparse.
  const double area = std::max({size.x * size.y, size.y * size.z, size.x * size.z});
  return 4 * std::sqrt(std::max(area, 1e-12) * neighbours / static_cast<double>(std::max<std::size_t>(points.size(), 1)));
}

Result<void> forTiles(std::span<const glm::dvec3> points, double margin, const char* what, const Progress& progress,
                      const std::function<void(const TileSearch&)>& work) {
  if (points.size() >= UINT32_MAX) return fail("The cloud has more points than can be cleaned at once", {}, "Clean its scans one by one");
  const PointTiles tiles(points, kTilePoints, false);
  std::atomic<std::size_t> done = 0;
  std::mutex mutex;
  std::optional<Error> failure;
  parallelFor(tiles.count(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      if (progress.cancelled()) return;
      try {
        TileSearch search;
        search.index = tiles.around(i, margin);
        search.ownCount = tiles.own(i).size();
        search.origin = tiles.bounds(i).centre();
        search.cloud = pclCloud(points, search.index, search.origin);
        search.tree.setInputCloud(search.cloud);
        work(search);
      } catch (const std::exception& error) {
        const std::lock_guard lock(mutex);
        failure = Error{std::string("The points cannot be searched: ") + error.what(), {}, "Thin the cloud first"};
      }
      progress.report(static_cast<double>(++done) / static_cast<double>(tiles.count()), what);
    }
  });
  if (progress.cancelled()) return fail(cancelledError());
  if (failure) return fail(*failure);
  return {};
}

}  // namespace alidade
