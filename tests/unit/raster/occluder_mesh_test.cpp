// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occluder_mesh.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "raster/mesh_pass.h"
#include "raster/occlusion.h"
#include "unit/cloud/test_clouds.h"
#include "unit/raster/occlusion_score.h"

namespace alidade {
namespace {

using test::kStreetView;
using test::savePicture;
using test::Score;
using test::scoreOf;
using test::streetCamera;
using test::StreetScene;
using test::truthOf;

const std::vector<glm::dvec3> kStations{{0.5, -1.0, 1.8}, {18, 2.5, 1.8}};

PointBatch scanStreet(const StreetScene& scene, std::size_t points, double jitter = 0.1) {
  PointBatch batch;
  for (std::size_t s = 0; s < kStations.size(); ++s) {
    scene.scan(kStations[s], points / kStations.size(), 0.003, static_cast<std::uint32_t>(s + 1), batch,
               jitter, static_cast<std::uint16_t>(s));
  }
  return batch;
}

std::vector<Station> stationsAt(const std::vector<glm::dvec3>& places, const glm::dvec3& offset = {}) {
  std::vector<Station> stations;
  for (const glm::dvec3& place : places) {
    Station station;
    station.worldFromScanner.translation = place + offset;
    stations.push_back(station);
  }
  return stations;
}

std::shared_ptr<const OccluderMesh> meshOf(const PointBatch& batch, const std::vector<Station>& stations) {
  OccluderMeshBuilder builder(stations);
  builder.add(batch);
  return std::make_shared<OccluderMesh>(builder.build());
}

Score scoreStreet(std::size_t points, int width, int height) {
  const StreetScene scene;
  const Camera camera = streetCamera(width, height);
  const auto mesh = meshOf(scanStreet(scene, points), stationsAt(kStations));
  const DepthImage truth = truthOf(scene, camera, kStreetView);
  const DepthImage depth = occlusionDepth(Occluders{{}, {mesh}}, camera, kStreetView).depth;
  savePicture("mesh_" + std::to_string(points / 1000) + "k", truth, depth, depth);
  const Score score = scoreOf(truth, depth, true), edges = scoreOf(truth, depth, false);
  std::printf(
      "%8zu returns, %zu merged, %zu cells, %zu squares: precision %.2f recall %.2f unknown %.2f | within 2 px "
      "of edges %.2f %.2f %.2f\n",
      points, static_cast<std::size_t>(mesh->mergedQuads), static_cast<std::size_t>(mesh->cellQuads),
      static_cast<std::size_t>(mesh->borderSquares), score.precision, score.recall, score.unknown,
      edges.precision, edges.recall, edges.unknown);
  return score;
}

TEST(OccluderMesh, KnowsAStreetFromItsScannersGrids) {
  // Bounds a little below what is reached (97.4/97.2, 99.0/98.8 when written; 99.7/99.5 with 5 M at 1080p).
  const Score sparse = scoreStreet(100'000, 640, 360);
  EXPECT_GT(sparse.precision, 97.0);
  EXPECT_GT(sparse.recall, 96.5);
  const Score medium = scoreStreet(400'000, 640, 360);
  EXPECT_GT(medium.precision, 98.7);
  EXPECT_GT(medium.recall, 98.5);
  // Here the second scanner's columns fall on the railing's posts one after the other: a wall, as far as its
  // grid can tell (97.0/96.9 when written).
  const Score dense = scoreStreet(1'500'000, 640, 360);
  EXPECT_GT(dense.precision, 96.5);
  EXPECT_GT(dense.recall, 96.5);
  if (std::getenv("ALIDADE_TEST_PICTURES")) scoreStreet(5'000'000, 1920, 1080);
}

/// A wall 5 m from a scanner at the origin, 200 × 200 returns about the x axis, with a square opening.
PointBatch wallWithOpening(const glm::dvec3& offset, double noise) {
  PointBatch batch;
  std::mt19937 random(3);
  std::normal_distribution<double> off(0.0, noise);
  for (std::uint32_t row = 0; row < 200; ++row) {
    for (std::uint32_t column = 0; column < 200; ++column) {
      const double y = (column - 99.5) * 0.004, z = (row - 99.5) * 0.004;
      if (std::max(std::abs(y), std::abs(z)) < 0.1) continue;
      const double range = 5.0 + off(random);
      // Sixteenths of a millimetre: exactly shiftable by whole metres.
      batch.position.push_back(glm::round(glm::dvec3(range, range * y, range * z) * 16384.0) / 16384.0 + offset);
      batch.row.push_back(row);
      batch.column.push_back(column);
    }
  }
  return batch;
}

/// The wall fills the picture and more.
RigidTransform wallView(const glm::dvec3& offset) {
  return RigidTransform::cameraLookingAt(glm::dvec3(2.5, 0.25, 0.125) + offset, glm::dvec3(5, 0.25, 0.125) + offset);
}

TEST(OccluderMesh, AWallIsWhereItStandsAndItsOpeningStaysUnknown) {
  const auto mesh = meshOf(wallWithOpening({}, 0.001), stationsAt({{0, 0, 0}}));
  EXPECT_EQ(mesh->returns, 200u * 200u - 50u * 50u);
  // Merging is what makes a frame cheap.
  EXPECT_LT(mesh->mergedQuads + mesh->cellQuads, 3000u);
  const Camera camera = test::pinhole(400, 400, 500);
  const DepthImage depth = occlusionDepth(Occluders{{}, {mesh}}, camera, wallView({})).depth;
  std::size_t inside = 0;
  for (int y = 0; y < 400; ++y) {
    for (int x = 0; x < 400; ++x) {
      // Where the pixel's ray meets the wall.
      const double side = 0.25 - (x - 199.5) / 500 * 2.5, up = 0.125 - (y - 199.5) / 500 * 2.5;
      const double away = std::max(std::abs(side), std::abs(up));
      if (away < 0.5 - 0.022) {
        ++inside;
        ASSERT_TRUE(std::isnan(depth.at(x, y))) << x << " " << y;
      }
      if (away > 0.5 + 0.022) {
        ASSERT_NEAR(depth.at(x, y), 2.5f, 0.006f) << x << " " << y;
      }
    }
  }
  EXPECT_GT(inside, 10'000u);
}

TEST(OccluderMesh, TenThousandKilometresAwayIsTheSamePicture) {
  const glm::dvec3 far(1e7, -1e7, 1e3);
  const Camera camera = test::pinhole(300, 300, 400);
  const DepthImage a =
      occlusionDepth(Occluders{{}, {meshOf(wallWithOpening({}, 0.001), stationsAt({{0, 0, 0}}))}}, camera,
                     wallView({}))
          .depth;
  const DepthImage b =
      occlusionDepth(Occluders{{}, {meshOf(wallWithOpening(far, 0.001), stationsAt({{0, 0, 0}}, far))}}, camera,
                     wallView(far))
          .depth;
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool same = std::isnan(a.data()[i]) ? std::isnan(b.data()[i])
                                              : std::abs(a.data()[i] - b.data()[i]) < 1e-5f;
    different += !same;
  }
  EXPECT_LE(different, a.size() / 2000);
}

TEST(OccluderMesh, ThreeKernelsGiveOnePicture) {
  const StreetScene scene;
  const auto mesh = meshOf(scanStreet(scene, 100'000), stationsAt(kStations));
  const Camera camera = streetCamera(633, 357);
  const Image<float> fastest = drawMeshes({mesh}, camera, kStreetView);
  for (const char* kernel : {"avx2", "scalar"}) {
    setenv("ALIDADE_SIMD", kernel, 1);
    const Image<float> other = drawMeshes({mesh}, camera, kStreetView);
    unsetenv("ALIDADE_SIMD");
    std::size_t different = 0;
    for (std::size_t i = 0; i < other.size(); ++i) different += other.data()[i] != fastest.data()[i];
    EXPECT_EQ(different, 0u) << kernel;
  }
}

TEST(OccluderMesh, AWallThatPassesTheCameraIsCutAtTheLens) {
  // The camera stands 5 cm before the wall and looks along it: quads reach behind it and beyond the fold.
  const auto mesh = meshOf(wallWithOpening({}, 0.0), stationsAt({{0, 0, 0}}));
  const Camera camera = streetCamera(320, 240);
  const RigidTransform view = RigidTransform::cameraLookingAt({4.95, 0.75, 0.5}, {4.95, 3, 0.5});
  const DepthImage depth = occlusionDepth(Occluders{{}, {mesh}}, camera, view).depth;
  std::size_t known = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (std::isnan(depth.at(x, y))) continue;
      const auto ray = camera.unproject(glm::dvec2(x, y));
      ASSERT_TRUE(ray);
      // The wall is 5 cm to the right or left: z x = 0.05.
      ++known;
      ASSERT_NEAR(std::abs(ray->x) * depth.at(x, y), 0.05, 0.002) << x << " " << y;
    }
  }
  EXPECT_GT(known, 5'000u);
}

TEST(OccluderMesh, ReturnsWithoutAGridAreCountedAndNotGuessed) {
  PointBatch unordered;
  unordered.position = {{1, 0, 0}, {2, 0, 0}};
  OccluderMeshBuilder builder(stationsAt({{0, 0, 0}}));
  builder.add(unordered);
  // A header that claims a grid of 2^64 cells, and a station that nobody named.
  PointBatch lying;
  lying.position.assign(8, {3, 0, 0});
  lying.row = {0, 1, 2, 3, 4, 5, 6, 0xffffffff};
  lying.column = {0xffffffff, 1, 2, 3, 4, 5, 6, 0};
  lying.scanner = {0, 0, 0, 0, 0, 0, 0, 0};
  builder.add(lying);
  lying.scanner.assign(8, 7);
  builder.add(lying);
  const OccluderMesh mesh = builder.build();
  EXPECT_EQ(mesh.returns, 0u);
  EXPECT_EQ(mesh.withoutGrid, 18u);
  EXPECT_TRUE(mesh.packs.empty());
}

}  // namespace
}  // namespace alidade
