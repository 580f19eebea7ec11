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

TEST(RigidTransform, AMatrixFromAFileIsMadeARotationOrRefused) {
  const glm::dmat3 exact = glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, -3))));
  const auto again = nearestRotation(exact);
  ASSERT_TRUE(again);
  EXPECT_NEAR(rotationAngleBetween({*again, {}}, RigidTransform::fromMatrix(exact, {})), 0, 1e-15);
  glm::dmat3 rounded = exact;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) rounded[c][r] = std::round(exact[c][r] * 1e4) / 1e4;
  ASSERT_TRUE(nearestRotation(rounded));
  EXPECT_LT(rotationAngleBetween({*nearestRotation(rounded), {}}, RigidTransform::fromMatrix(exact, {})), 1e-4);
  EXPECT_FALSE(nearestRotation(2.0 * exact));
  EXPECT_FALSE(nearestRotation(glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, -1))) << "a mirror";
  EXPECT_FALSE(nearestRotation(glm::dmat3(0.0)));
  EXPECT_FALSE(nearestRotation(glm::dmat3(std::nan(""), 0, 0, 0, 1, 0, 0, 0, 1)));
}

}  // namespace alidade
