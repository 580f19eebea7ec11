// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "base/error.h"
#include "base/progress.h"
#include "cleaning/point_tiles.h"

namespace alidade {

// Inside this folder alone: PCL's search trees over tiles.

/// One tile with its surroundings, in float about `origin`, and a search tree over it.
struct TileSearch {
  std::vector<std::uint32_t> index;  ///< into the whole cloud; the tile's own points first
  std::size_t ownCount = 0;
  glm::dvec3 origin{0};
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
};

/// Calls `work` for every tile of the cloud, several at a time. Error when cancelled, for too many points, and for an
/// exception of the library.
Result<void> forTiles(std::span<const glm::dvec3> points, double margin, const char* what, const Progress& progress,
                      const std::function<void(const TileSearch&)>& work);

/// The cloud in float about an origin.
pcl::PointCloud<pcl::PointXYZ>::Ptr pclCloud(std::span<const glm::dvec3> points, std::span<const std::uint32_t> index, const glm::dvec3& origin);

/// A length within which most points have some `neighbours` others, from the cloud's extent and count.
double typicalReach(std::span<const glm::dvec3> points, int neighbours);

}  // namespace alidade
