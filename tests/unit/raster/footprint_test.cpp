// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "raster/splatter.h"
#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

using test::storeFrom;

/// A rectangle corner + s a + t b, s and t in [0, 1], with one point at random in each of its cells.
struct Panel {
  glm::dvec3 corner, a, b;

  PointBatch points(std::size_t count) const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double edge = std::sqrt(glm::length(a) * glm::length(b) / static_cast<double>(count));
    const int along = static_cast<int>(glm::length(a) / edge),
              across = static_cast<int>(glm::length(b) / edge);
    PointBatch batch;
    for (int i = 0; i < along; ++i)
      for (int j = 0; j < across; ++j)
        batch.position.push_back(corner + (i + unit(random)) / along * a + (j + unit(random)) / across * b);
    return batch;
  }

  /// Depth where the pixel's ray meets it; +inf where it does not.
  double depth(const Camera& camera, const RigidTransform& cameraFromWorld, const glm::dvec2& pixel) const {
    const double inf = std::numeric_limits<double>::infinity();
    const auto ray = camera.unproject(pixel);
    if (!ray) return inf;
    const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
    const glm::dvec3 c = cameraFromWorld * corner, u = rotation * a, v = rotation * b;
    const glm::dvec3 direction = *ray / ray->z;
    const glm::dvec3 st = glm::inverse(glm::dmat3(u, v, -direction)) * -c;
    return st.x >= 0 && st.x <= 1 && st.y >= 0 && st.y <= 1 && st.z > 0 ? st.z : inf;
  }
};

struct Score {
  double meanError = 0;  ///< of the depth, relative, where both are
  double missing = 0;    ///< of the true pixels, not covered
  double fattened = 0;   ///< pixels covered beyond the true ones, as a part of them
};

Score scoreOf(const Panel& panel, const Camera& camera, const RigidTransform& pose,
              const SplatOptions& options, std::size_t points) {
  const auto store = storeFrom(panel.points(points));
  const SplatImages drawn = splat({{store, selectAll(*store, camera, pose)}}, camera, pose, options);
  double trueCount = 0, both = 0, beyond = 0, error = 0;
  for (int y = 0; y < camera.height(); ++y) {
    for (int x = 0; x < camera.width(); ++x) {
      const double expected = panel.depth(camera, pose, {x, y});
      const double z = drawn.depth.at(x, y);
      trueCount += std::isfinite(expected);
      if (std::isfinite(expected) && std::isfinite(z)) both += 1, error += std::abs(z - expected) / expected;
      beyond += std::isfinite(z) && !std::isfinite(expected);
    }
  }
  return {error / both, (trueCount - both) / trueCount, beyond / trueCount};
}

Camera brown() {
  return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 640, 480,
                                            {420, 420, 318.2, 241.7, -0.21, 0.06, 0.001, -0.002, -0.01}));
}

TEST(Footprints, LieInTheSurfaceOfAGrazingFloor) {
  // A floor 1.5 m below the eye, 2 to 12 m away: seen at 37 to 7 degrees.
  const Panel floor{{-4, 2, 0}, {8, 0, 0}, {0, 10, 0}};
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 1.5}, {0, 10, 0.5});
  for (const Camera& camera : {brown(), test::pinhole(640, 480, 420)}) {
    for (const bool round : {false, true}) {
      const SplatOptions planar{.pointSize = 1.5, .round = round};
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
  const SplatOptions planar{.pointSize = 1.5};
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
  const Score with = scoreOf(board, camera, pose, {}, 20'000),
              without = scoreOf(board, camera, pose, {.planar = false}, 20'000);
  // But for cells that hold fewer points by chance, whose footprints are wider.
  EXPECT_NEAR(with.missing, without.missing, 0.001);
  EXPECT_NEAR(with.fattened, without.fattened, 0.001);
  EXPECT_LT(with.meanError, 1e-4);
}

/// A board whose right half holds an eighth of the left one's points, at random, in nodes that hold both.
TEST(Footprints, AreWiderWhereTheScanIsSparser) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  PointBatch batch;
  for (int i = 0; i < 20'000; ++i) {
    const double x = -2 + 4 * unit(random);
    if (x < 0 || i % 8 == 0) batch.position.push_back({x, 4, -1.5 + 3 * unit(random)});
  }
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const Camera camera = test::pinhole(640, 480, 420);
  const auto store = storeFrom(batch);
  const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, pose)}};
  const auto bareOf = [&](const SplatImages& images) {
    std::size_t bare = 0;
    for (int y = 120; y < 360; ++y)
      for (int x = 340; x < 500; ++x) bare += std::isinf(images.depth.at(x, y));
    return static_cast<double>(bare) / (240 * 160);
  };
  EXPECT_LT(bareOf(splat(layers, camera, pose, {})), 0.3);
  EXPECT_GT(bareOf(splat(layers, camera, pose, {.planar = false})), 0.6);
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
  const SplatImages domes = splat(layers, camera, pose, {}),
                    squares = splat(layers, camera, pose, {.planar = false});
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
