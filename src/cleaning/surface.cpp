// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/surface.h"

#include <cmath>
#include <exception>

#include <fmt/format.h>
#include <pcl/conversions.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>
#include <pcl/surface/poisson.h>

#include "geometry/bounds.h"

namespace alidade {

namespace {

constexpr std::size_t kMostPoints = 20000000;

struct Prepared {
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud;
  glm::dvec3 origin;
};

Result<Prepared> prepare(std::span<const glm::dvec3> points, std::span<const glm::vec3> normals) {
  if (points.size() < 3) return fail("A surface needs at least three points");
  if (points.size() > kMostPoints) return fail(fmt::format("A surface of {} points is not made", points.size()), {}, "Thin the cloud first");
  if (normals.size() != points.size()) return fail("A surface needs a normal for every point");
  Bounds bounds;
  for (const glm::dvec3& p : points) bounds.add(p);
  Prepared prepared{std::make_shared<pcl::PointCloud<pcl::PointNormal>>(), bounds.centre()};
  prepared.cloud->points.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::vec3 p(points[i] - prepared.origin);
    pcl::PointNormal& to = prepared.cloud->points[i];
    to.x = p.x, to.y = p.y, to.z = p.z;
    to.normal_x = normals[i].x, to.normal_y = normals[i].y, to.normal_z = normals[i].z;
  }
  prepared.cloud->width = static_cast<std::uint32_t>(points.size());
  prepared.cloud->height = 1;
  return prepared;
}

std::vector<std::array<std::uint32_t, 3>> trianglesOf(const std::vector<pcl::Vertices>& polygons, std::size_t vertexCount) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const pcl::Vertices& polygon : polygons) {
    if (polygon.vertices.size() != 3) continue;
    std::array<std::uint32_t, 3> corners{};
    bool good = true;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = static_cast<std::uint32_t>(polygon.vertices[k]);
      good = good && corners[k] < vertexCount;
    }
    if (good) triangles.push_back(corners);
  }
  return triangles;
}

Error failed(const std::exception& error) { return {std::string("The surface cannot be made: ") + error.what(), {}, "Thin or clean the cloud first"}; }

}  // namespace

Result<SurfaceMesh> meshGreedily(std::span<const glm::dvec3> points, std::span<const glm::vec3> normals, const GreedyOptions& options,
                                 const Progress& progress) {
  if (!(options.edgeMeters > 0) || !std::isfinite(options.edgeMeters)) return fail("The longest edge must be above 0");
  auto prepared = prepare(points, normals);
  if (!prepared) return fail(prepared.error());
  progress.report(0.1, "Joining points");
  if (progress.cancelled()) return fail(cancelledError());
  SurfaceMesh mesh;
  try {
    auto tree = std::make_shared<pcl::search::KdTree<pcl::PointNormal>>();
    tree->setInputCloud(prepared->cloud);
    pcl::GreedyProjectionTriangulation<pcl::PointNormal> greedy;
    greedy.setSearchRadius(options.edgeMeters);
    greedy.setMu(2.5);
    greedy.setMaximumNearestNeighbors(100);
    greedy.setMaximumSurfaceAngle(M_PI / 4);
    greedy.setMinimumAngle(M_PI / 18);
    greedy.setMaximumAngle(2 * M_PI / 3);
    greedy.setNormalConsistency(true);
    greedy.setInputCloud(prepared->cloud);
    greedy.setSearchMethod(tree);
    std::vector<pcl::Vertices> polygons;
    greedy.reconstruct(polygons);
    mesh.vertices.assign(points.begin(), points.end());
    mesh.triangles = trianglesOf(polygons, points.size());
  } catch (const std::exception& error) {
    return fail(failed(error));
  }
  if (progress.cancelled()) return fail(cancelledError());
  progress.report(1.0, "Joining points");
  return mesh;
}

Result<SurfaceMesh> meshByPoisson(std::span<const glm::dvec3> points, std::span<const glm::vec3> normals, const PoissonOptions& options,
                                  const Progress& progress) {
  if (options.depth < 2 || options.depth > 13) return fail(fmt::format("Poisson's octree cannot be {} deep", options.depth), {}, "Give 2 to 13");
  auto prepared = prepare(points, normals);
  if (!prepared) return fail(prepared.error());
  progress.report(0.1, "Reconstructing a surface");
  if (progress.cancelled()) return fail(cancelledError());
  SurfaceMesh mesh;
  try {
    pcl::Poisson<pcl::PointNormal> poisson;
    poisson.setDepth(options.depth);
    poisson.setInputCloud(prepared->cloud);
    pcl::PointCloud<pcl::PointNormal> surface;
    std::vector<pcl::Vertices> polygons;
    poisson.reconstruct(surface, polygons);
    for (const pcl::PointNormal& p : surface.points) mesh.vertices.push_back(prepared->origin + glm::dvec3(p.x, p.y, p.z));
    mesh.triangles = trianglesOf(polygons, mesh.vertices.size());
  } catch (const std::exception& error) {
    return fail(failed(error));
  }
  if (progress.cancelled()) return fail(cancelledError());
  progress.report(1.0, "Reconstructing a surface");
  return mesh;
}

}  // namespace alidade
