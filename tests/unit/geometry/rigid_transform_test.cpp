// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/rigid_transform.h"

#include <cmath>

#include <gtest/gtest.h>

namespace alidade {

TEST(RigidTransform, ACameraLookingNorthSeesEastOnTheRightAndUpAtTheTop) {
  const auto cameraFromWorld = RigidTransform::cameraLookingAt({10, 20, 2}, {10, 30, 2});
  const glm::dvec3 east = cameraFromWorld * glm::dvec3(11, 25, 2);
  const glm::dvec3 above = cameraFromWorld * glm::dvec3(10, 25, 3);
  EXPECT_NEAR(east.x, 1, 1e-12);
  EXPECT_NEAR(east.z, 5, 1e-12);
  EXPECT_NEAR(above.y, -1, 1e-12);
}

TEST(RigidTransform, TheInverseUndoesIt) {
  const auto a = RigidTransform::cameraLookingAt({100600, 196250, 80}, {100590, 196270, 6});
  const glm::dvec3 p(100610.5, 196260.25, 6.125);
  EXPECT_LT(glm::length(a.inverse() * (a * p) - p), 1e-9);
  EXPECT_LT(glm::length((a.inverse() * a).translation), 1e-9);
  EXPECT_LT(glm::length(a.centre() - glm::dvec3(100600, 196250, 80)), 1e-9);
}

TEST(RigidTransform, AnInterpolatedCameraMovesOnTheStraightLine) {
  const auto a = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 10, 0});
  const auto b = RigidTransform::cameraLookingAt({2, 0, 0}, {12, 0, 0});
  const auto middle = interpolateCameraPose(a, b, 0.5);
  EXPECT_LT(glm::length(middle.centre() - glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_NEAR(rotationAngleBetween(a, middle), rotationAngleBetween(middle, b), 1e-12);
}

}  // namespace alidade
