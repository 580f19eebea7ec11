// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "camera/rolling_shutter.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace alidade {

namespace {

Camera hdCamera() {
  return Camera(*Intrinsics::fromParameters(CameraModel::OpenCv5, 1920, 1080,
                                            {1150, 1150, 959.5, 539.5, -0.12, 0.03, 0.0005, -0.0004, -0.002}));
}

/// By brute force: of all rows in steps of a thousandth, the one at which the point is seen in that row.
std::optional<glm::dvec2> bruteForce(const Camera& camera, const RollingShutter& shutter, const glm::dvec3& p) {
  double best = 1e9;
  std::optional<glm::dvec2> seen;
  const auto look = [&](double from, double to, double step) {
    double at = from;
    for (double row = from; row <= to; row += step) {
      const auto pixel = camera.project(exponential(shutter.motion * shutter.secsAtRow(row, camera.height())) * p);
      if (pixel && std::abs(pixel->y - row) < best) best = std::abs(pixel->y - row), seen = pixel, at = row;
    }
    return at;
  };
  const double coarse = look(-100, 1180, 1);
  look(coarse - 1, coarse + 1, 1e-3);
  return best < 0.01 ? seen : std::nullopt;
}

}  // namespace

TEST(RollingShutter, APointIsSeenInTheRowThatIsReadWhenItIsThere) {
  const Camera camera = hdCamera();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(-1, 1);
  double farthest = 0;
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    // A walker's camera: up to 1 rad/s and 1.5 m/s; a phone reads for up to 33 ms.
    const RollingShutter shutter{0.033 * part(random),
                                 {glm::dvec3(part(random), part(random), part(random)), 1.5 * glm::dvec3(part(random), part(random), part(random))}};
    const double z = 1.5 + 10 * std::abs(part(random));
    const glm::dvec3 p(0.7 * z * part(random), 0.4 * z * part(random), z);
    const auto truth = bruteForce(camera, shutter, p), found = project(camera, shutter, p), still = camera.project(p);
    if (!truth) continue;
    ASSERT_TRUE(found);
    ++compared;
    EXPECT_LT(glm::length(*found - *truth), 0.01);
    farthest = std::max(farthest, glm::length(*truth - *still));
  }
  EXPECT_GT(compared, 250);
  EXPECT_GT(farthest, 10) << "else the test would pass without a shutter";
}

TEST(RollingShutter, OffItChangesNothing) {
  const Camera camera = hdCamera();
  const glm::dvec3 p(0.3, -0.2, 4);
  EXPECT_EQ(*project(camera, {}, p), *camera.project(p));
  EXPECT_EQ(*project(camera, {0.03, {}}, p), *camera.project(p)) << "a camera that stands still";
  EXPECT_FALSE(project(camera, {0.03, {{0, 0, 1}, {}}}, {0, 0, -1}));
}

TEST(RollingShutter, TheMiddleRowHasTheFramesPose) {
  const RollingShutter shutter{0.02, {{0, 0.5, 0}, {1, 0, 0}}};
  const auto pose = RigidTransform::cameraLookingAt({1, 2, 3}, {4, 8, 2});
  EXPECT_LT(glm::length(shutter.poseAtRow(pose, 539.5, 1080).translation - pose.translation), 1e-12);
  EXPECT_DOUBLE_EQ(shutter.secsAtRow(1079.5, 1080), 0.01);
  EXPECT_DOUBLE_EQ(shutter.secsAtRow(-0.5, 1080), -0.01);
}

}  // namespace alidade
