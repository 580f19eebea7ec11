// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/occlusion.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"
#include "unit/raster/occlusion_score.h"

namespace alidade {
namespace {

using test::kStreetView;
using test::savePicture;
using test::Score;
using test::scoreOf;
using test::storeFrom;
using test::streetCamera;
using test::StreetScene;
using test::truthOf;

std::shared_ptr<const PointStore> scanned(const StreetScene& scene, std::size_t points) {
  PointBatch batch;
  scene.scan({0.5, -1.0, 1.8}, points / 2, 0.003, 1, batch);
  scene.scan({18, 2.5, 1.8}, points / 2, 0.003, 2, batch);
  return storeFrom(batch);
}

Score scoreStreet(std::size_t points, int width, int height) {
  const StreetScene scene;
  const Camera camera = streetCamera(width, height);
  const auto store = scanned(scene, points);
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, kStreetView)}};
  const DepthImage truth = truthOf(scene, camera, kStreetView);
  const OcclusionDepth occlusion = occlusionDepth(layers, camera, kStreetView);
  const DepthImage dots = splat(layers, camera, kStreetView, {.maximumSizePx = 1.0}).depth;
  savePicture("street_" + std::to_string(points / 1000) + "k", truth, dots, occlusion.depth);
  const Score score = scoreOf(truth, occlusion.depth, true), edges = scoreOf(truth, occlusion.depth, false);
  std::printf(
      "%8zu points %dx%d: precision %.2f recall %.2f unknown %.2f | within 2 px of edges %.2f %.2f %.2f\n",
      points, width, height, score.precision, score.recall, score.unknown, edges.precision, edges.recall,
      edges.unknown);
  return score;
}

TEST(Occlusion, KnowsAStreetFromItsScanAndSaysWhatItDoesNotKnow) {
  // Bounds a little below what is reached (98.4/88.7, 99.1/93.3, 99.3/96.6 when written).
  const Score sparse = scoreStreet(100'000, 640, 360);
  EXPECT_GT(sparse.precision, 98.0);
  EXPECT_GT(sparse.recall, 87.0);
  const Score medium = scoreStreet(400'000, 640, 360);
  EXPECT_GT(medium.precision, 98.5);
  EXPECT_GT(medium.recall, 92.0);
  const Score dense = scoreStreet(1'500'000, 640, 360);
  EXPECT_GT(dense.precision, 98.5);
  EXPECT_GT(dense.recall, 95.5);
}

TEST(Occlusion, AWallHidesWhatShinesThroughItsDots) {
  // Two walls, 5 and 8 m away, both dotted 4 px apart on screen: between the near dots the far ones
  // show, and every one of them must go.
  PointBatch batch;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> side(-3.0, 3.0);
  for (int i = 0; i < 9000; ++i) batch.position.push_back({side(random), side(random), 5.0});
  for (int i = 0; i < 20000; ++i) batch.position.push_back({2 * side(random), 2 * side(random), 8.0});
  const auto store = storeFrom(batch);
  const Camera camera = test::pinhole(400, 400, 320);
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, {})}};
  const SplatImages dots = splat(layers, camera, {}, {.maximumSizePx = 1.0});
  const DepthImage depth = occlusionDepth(layers, camera, {}).depth;
  std::size_t shining = 0, through = 0, unknown = 0;
  for (int y = 40; y < 360; ++y) {
    for (int x = 40; x < 360; ++x) {
      shining += dots.depth.at(x, y) > 6.0f && std::isfinite(dots.depth.at(x, y));
      through += depth.at(x, y) > 6.0f;
      unknown += std::isnan(depth.at(x, y));
    }
  }
  ASSERT_GT(shining, 5000u);
  EXPECT_LT(through, shining / 100);
  EXPECT_LT(unknown, 320u * 320u / 20);
}

TEST(Occlusion, AHoleInADenseSurfaceStaysUnknown) {
  // A wall dotted 0.5 px apart with a square opening of 40 px and nothing behind it.
  PointBatch batch;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> side(-2.0, 2.0);
  for (int i = 0; i < 640'000; ++i) {
    const glm::dvec3 p(side(random), side(random), 4.0);
    if (std::max(std::abs(p.x), std::abs(p.y)) > 0.2) batch.position.push_back(p);
  }
  const auto store = storeFrom(batch);
  const Camera camera = test::pinhole(300, 300, 400);
  const DepthImage depth = occlusionDepth({{store, selectAll(*store, camera, {})}}, camera, {}).depth;
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; ++x) {
      const double away = std::max(std::abs(x - 149.5), std::abs(y - 149.5));
      const float z = depth.at(x, y);
      ASSERT_TRUE(away >= 17 || std::isnan(z)) << x << " " << y;
      ASSERT_TRUE(away <= 23 || std::abs(z - 4.0f) < 0.01f) << x << " " << y << " " << z;
    }
  }
}

TEST(Occlusion, NothingScannedIsUnknownEverywhere) {
  const Camera camera = test::pinhole(64, 48, 50);
  const DepthImage depth = occlusionDepth(Occluders{}, camera, {}).depth;
  for (std::size_t i = 0; i < depth.size(); ++i) EXPECT_TRUE(std::isnan(depth.data()[i]));
}

TEST(Visibility, ComparesDepthWithToleranceAndKeepsItsFourAnswersApart) {
  DepthImage depth(4, 3, 10.0f);
  depth.at(1, 1) = std::numeric_limits<float>::quiet_NaN();
  depth.at(2, 1) = std::numeric_limits<float>::infinity();
  EXPECT_EQ(visibilityAt(depth, {0, 0}, 9.0, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {0, 0}, 10.0249, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {0, 0}, 10.0251, 0.02), Visibility::Hidden);
  EXPECT_EQ(visibilityAt(depth, {1.4, 0.6}, 5.0, 0.02), Visibility::Unknown);
  EXPECT_EQ(visibilityAt(depth, {2, 1}, 1e9, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {-0.51, 0}, 5.0, 0.02), Visibility::Outside);
  EXPECT_EQ(visibilityAt(depth, {-0.49, 0}, 5.0, 0.02), Visibility::Visible);
  EXPECT_EQ(visibilityAt(depth, {3.5, 0}, 5.0, 0.02), Visibility::Outside);
  EXPECT_EQ(visibilityAt(depth, {0, 0}, -1.0, 0.02), Visibility::Outside);
  EXPECT_EQ(visibilityAt(depth, {std::nan(""), 0}, 5.0, 0.02), Visibility::Outside);
}

}  // namespace
}  // namespace alidade
