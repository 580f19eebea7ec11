// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/attitude.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "geometry/device_chain.h"

namespace alidade {

namespace {

constexpr double kQuarter = std::numbers::pi / 2;

/// Where the camera's right, down and forward point in the world.
struct Axes {
  glm::dvec3 right, down, forward;
  explicit Axes(const glm::dquat& r) : right(r * glm::dvec3(1, 0, 0)), down(r * glm::dvec3(0, 1, 0)), forward(r * glm::dvec3(0, 0, 1)) {}
};

testing::AssertionResult isNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-14) {
  for (int i = 0; i < 3; ++i)
    if (!(std::abs(a[i] - b[i]) <= tolerance))
      return testing::AssertionFailure() << a.x << " " << a.y << " " << a.z << " is not " << b.x << " " << b.y << " " << b.z;
  return testing::AssertionSuccess();
}

const glm::dvec3 kEast(1, 0, 0), kNorth(0, 1, 0), kUp(0, 0, 1);

double angleBetween(const glm::dquat& a, const glm::dquat& b) {
  return rotationAngleBetween({a, {}}, {b, {}});
}

}  // namespace

TEST(Attitude, AllAnglesZeroLookStraightDownWithTheTopToTheNorth) {
  for (const glm::dquat& r : {worldFromCameraRotation({}), worldFromFloorCamera({})}) {
    const Axes axes(r);
    EXPECT_TRUE(isNear(axes.right, kEast));
    EXPECT_TRUE(isNear(axes.down, -kNorth));
    EXPECT_TRUE(isNear(axes.forward, -kUp));
  }
  const Axes nose(worldFromNoseCamera({}));
  EXPECT_TRUE(isNear(nose.right, kEast));
  EXPECT_TRUE(isNear(nose.down, -kUp));
  EXPECT_TRUE(isNear(nose.forward, kNorth));
}

TEST(Attitude, EachPhotogrammetricAngleTurnsAsTheTextbookSays) {
  // Kraus: R = Rx(omega) Ry(phi) Rz(kappa), written out; photo axes are (right, -down, -forward).
  const double o = 0.31, p = -0.22, k = 2.4;
  const double co = std::cos(o), so = std::sin(o), cp = std::cos(p), sp = std::sin(p), ck = std::cos(k), sk = std::sin(k);
  const Axes axes(worldFromCameraRotation({o, p, k}));
  EXPECT_TRUE(isNear(axes.right, {cp * ck, co * sk + so * sp * ck, so * sk - co * sp * ck}));
  EXPECT_TRUE(isNear(-axes.down, {-cp * sk, co * ck - so * sp * sk, so * ck + co * sp * sk}));
  EXPECT_TRUE(isNear(-axes.forward, {sp, -so * cp, co * cp}));
}

TEST(Attitude, YawIsClockwisePitchNoseUpRollRightSideDown) {
  EXPECT_TRUE(isNear(Axes(worldFromFloorCamera({kQuarter, 0, 0})).down, -kEast)) << "heading east, the picture's top is east";
  EXPECT_TRUE(isNear(Axes(worldFromFloorCamera({0, kQuarter, 0})).forward, kNorth)) << "nose up: the floor looks ahead";
  EXPECT_TRUE(isNear(Axes(worldFromFloorCamera({0, 0, kQuarter})).forward, -kEast)) << "right side down: the floor looks left";
  EXPECT_TRUE(isNear(Axes(worldFromNoseCamera({kQuarter, 0, 0})).forward, kEast));
  EXPECT_TRUE(isNear(Axes(worldFromNoseCamera({0, -kQuarter, 0})).forward, -kUp));
  EXPECT_TRUE(isNear(Axes(worldFromNoseCamera({0, 0, kQuarter})).right, -kUp)) << "right side down";
  // A gimbal that looks straight down sees what a floor camera in level flight sees.
  EXPECT_NEAR(angleBetween(worldFromNoseCamera({0.7, -kQuarter, 0}), worldFromFloorCamera({0.7, 0, 0})), 0, 1e-14);
}

TEST(Attitude, OmegaPhiKappaGiveEveryRotationBackAlsoWherePhiIsARightAngle) {
  for (double o = -3; o <= 3; o += 0.5)
    for (const double p : {-kQuarter, -kQuarter + 1e-13, -kQuarter + 1e-9, -1.2, 0.0, 0.4, kQuarter - 1e-11, kQuarter})
      for (double k = -3; k <= 3; k += 0.5) {
        const glm::dquat r = worldFromCameraRotation({o, p, k});
        EXPECT_NEAR(angleBetween(worldFromCameraRotation(omegaPhiKappaOf(r)), r), 0, 2e-15) << o << " " << p << " " << k;
      }
  const OmegaPhiKappa angles = omegaPhiKappaOf(worldFromCameraRotation({0.1, -0.2, 3.0}));
  EXPECT_NEAR(angles.omega, 0.1, 1e-15);
  EXPECT_NEAR(angles.phi, -0.2, 1e-15);
  EXPECT_NEAR(angles.kappa, 3.0, 1e-15);
}

TEST(DeviceChain, FollowsThePublishedFormulaTermByTerm) {
  const RigidTransform worldFromSensor{glm::angleAxis(0.8, glm::normalize(glm::dvec3(1, -2, 0.5))), {512345.25, 5401234.5, 432.125}};
  const DeviceOffset offset{{0.12, -0.03, 0.31}, glm::angleAxis(-1.1, glm::normalize(glm::dvec3(0.2, 0.3, -1)))};
  const RigidTransform worldFromCamera = worldFromSensor * sensorFromCamera(offset);

  // Matrices written out, glm's columns first.
  const glm::dmat3 rWs = worldFromSensor.rotationMatrix(), rDc = glm::mat3_cast(offset.deviceFromCamera);
  const glm::dmat3 rWd({1, 0, 0}, {0, 0, 1}, {0, -1, 0});  // y to z, z to -y
  const glm::dmat3 rWc = rWs * rWd * rDc;
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(isNear(worldFromCamera.rotationMatrix()[c], rWc[c], 1e-15));
  EXPECT_TRUE(isNear(worldFromCamera.translation, worldFromSensor.translation + rWs * offset.cameraInDevice, 1e-9));
}

TEST(DeviceChain, ALevelDeviceThatLooksAlongItsOwnViewLooksAlongTheWorldsHorizon) {
  // A device whose own axes are x right, y up, z backwards, held level: the camera looks along -z of it,
  // which is north in the world, and its down is the world's down.
  const DeviceOffset offset{{0, 0, 0}, glm::dquat(0.0, 1.0, 0.0, 0.0)};
  const Axes axes(sensorFromCamera(offset).rotation);
  EXPECT_TRUE(isNear(axes.forward, kNorth));
  EXPECT_TRUE(isNear(axes.down, -kUp));
}

}  // namespace alidade
