// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <fmt/format.h>
#include <pcl/features/normal_3d.h>

#include "cleaning/cleaning.h"
#include "cleaning/tile_search.h"

namespace alidade {

Result<std::vector<glm::vec3>> estimateNormals(std::span<const glm::dvec3> points, std::span<const glm::dvec3> viewpoints,
                                               std::span<const std::uint16_t> seenFrom, const NormalOptions& options, const Progress& progress) {
  if (options.neighbours < 3 || options.neighbours > 1000)
    return fail(fmt::format("A normal cannot be taken from {} neighbours", options.neighbours), {}, "Give 3 to 1000");
  if (!seenFrom.empty() && seenFrom.size() != points.size()) return fail("The points do not say each which station saw it");
  std::vector<glm::vec3> normals(points.size(), glm::vec3(0, 0, 1));
  const auto ok = forTiles(points, typicalReach(points, options.neighbours), "Estimating normals", progress, [&](const TileSearch& tile) {
    pcl::Indices found;
    std::vector<float> squared;
    for (std::size_t i = 0; i < tile.ownCount; ++i) {
      Eigen::Vector4f plane;
      float curvature = 0;
      if (tile.tree.nearestKSearch(static_cast<int>(i), options.neighbours, found, squared) < 3 ||
          !pcl::computePointNormal(*tile.cloud, found, plane, curvature) || !plane.head<3>().allFinite())
        continue;
      const std::uint32_t index = tile.index[i];
      glm::vec3 normal(plane[0], plane[1], plane[2]);
      const std::size_t station = seenFrom.empty() ? 0 : seenFrom[index];
      const glm::dvec3 towards = station < viewpoints.size() ? viewpoints[station] - points[index] : glm::dvec3(0, 0, 1);
      if (glm::dot(glm::dvec3(normal), towards) < 0) normal = -normal;
      normals[index] = normal;
    }
  });
  if (!ok) return fail(ok.error());
  return normals;
}

}  // namespace alidade
