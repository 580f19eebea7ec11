// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raster/splatter.h"
#include "unit/cloud/test_clouds.h"
#include "unit/raster/panel.h"

namespace alidade {
namespace {

using test::brown;
using test::Panel;
using test::Score;
using test::scoreOf;
using test::storeFrom;

TEST(Footprints, LieInTheSurfaceOfAGrazingFloor) {
  // A floor 1.5 m below the eye, 2 to 12 m away: seen at 37 to 7 degrees.
  const Panel floor{{-4, 2, 0}, {8, 0, 0}, {0, 10, 0}};
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 1.5}, {0, 10, 0.5});
  for (const Camera& camera : {brown(), test::pinhole(640, 480, 420)}) {
    for (const bool round : {false, true}) {
      const SplatOptions planar{.pointSize = 1.5, .round = round, .surface = false};
      SplatOptions facing = planar;
      facing.planar = false;
      const Score with = scoreOf(floor, camera, pose, planar, 20'000),
                  without = scoreOf(floor, camera, pose, facing, 20'000);
      RecordProperty("planar_error_permille", std::to_string(1000 * with.meanError));
      RecordProperty("facing_error_permille", std::to_string(1000 * without.meanError));
      EXPECT_LT(with.meanError, 0.0005);
      EXPECT_GT(without.meanError, 0.01);
      EXPECT_LT(with.missing, 0.02);
    }
  }
}

TEST(Footprints, DoNotFattenAGrazingWall) {
  // 4 m of wall seen at 17 to 8 degrees, some 75 pixels of it, footprints of 5 to 12 pixels.
  const double slope = 5 * 3.14159265358979 / 180;
  const Panel wall{{0, 3, -0.5}, {4 * std::sin(slope), 4 * std::cos(slope), 0}, {0, 0, 1.5}};
  const auto pose = RigidTransform::cameraLookingAt({-1.2, 0, 0}, {0.1, 4, 0});
  const Camera camera = brown();
  const SplatOptions planar{.pointSize = 1.5, .surface = false};
  SplatOptions facing = planar;
  facing.planar = false;
  const Score with = scoreOf(wall, camera, pose, planar, 2'000),
              without = scoreOf(wall, camera, pose, facing, 2'000);
  RecordProperty("planar_fattened", std::to_string(with.fattened));
  RecordProperty("facing_fattened", std::to_string(without.fattened));
  EXPECT_LT(with.fattened, 0.5 * without.fattened);
  EXPECT_GT(without.fattened, 0.1);
  EXPECT_LT(with.meanError, 0.2 * without.meanError);
  EXPECT_LT(with.missing, 0.03);
}

TEST(Footprints, OfASurfaceThatFacesTheEyeAreTheSame) {
  const Panel board{{-2, 4, -1.5}, {4, 0, 0}, {0, 0, 3}};
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const Camera camera = test::pinhole(640, 480, 420);
  const Score with = scoreOf(board, camera, pose, {.surface = false}, 20'000),
              without = scoreOf(board, camera, pose, {.planar = false, .surface = false}, 20'000);
  // But for cells that hold fewer points by chance, whose footprints are wider.
  EXPECT_NEAR(with.missing, without.missing, 0.001);
  EXPECT_NEAR(with.fattened, without.fattened, 0.001);
  EXPECT_LT(with.meanError, 1e-4);
}

TEST(Footprints, AreWiderWhereTheScanIsSparser) {
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const Camera camera = test::pinhole(640, 480, 420);
  const auto store = storeFrom(test::boardWithASparserHalf());
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, pose)}};
  const auto bareOf = [&](const SplatImages& images) {
    std::size_t bare = 0;
    for (int y = 120; y < 360; ++y)
      for (int x = 340; x < 500; ++x) bare += std::isinf(images.depth.at(x, y));
    return static_cast<double>(bare) / (240 * 160);
  };
  EXPECT_LT(bareOf(splat(layers, camera, pose, {.surface = false})), 0.3);
  EXPECT_GT(bareOf(splat(layers, camera, pose, {.planar = false, .surface = false})), 0.6);
}

TEST(Footprints, WithoutASurfaceAreDomesThatFaceTheEye) {
  // A ball of points: no cell is a plane.
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.5);
  PointBatch batch;
  for (int i = 0; i < 5000; ++i)
    batch.position.push_back({normal(random), 5 + normal(random), normal(random)});
  const auto store = storeFrom(batch);
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const Camera camera = test::pinhole(640, 480, 420);
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, pose)}};
  const SplatImages domes = splat(layers, camera, pose, {.surface = false}),
                    squares = splat(layers, camera, pose, {.planar = false, .surface = false});
  std::size_t covered = 0, bare = 0, before = 0;
  for (std::size_t i = 0; i < domes.depth.size(); ++i) {
    const float dome = domes.depth.data()[i], square = squares.depth.data()[i];
    covered += std::isfinite(square);
    bare += std::isfinite(square) != std::isfinite(dome);
    before += dome < square;
  }
  // Few points a cell look like a plane by chance.
  ASSERT_GT(covered, 10'000u);
  EXPECT_LT(bare, covered / 10);
  EXPECT_LT(before, covered / 10);
}

}  // namespace
}  // namespace alidade
