// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/bearing.h"

#include <gtest/gtest.h>

#include "geometry/angle.h"

namespace alidade {
namespace {

void expectDirection(double azimuthDeg, double elevationDeg, const glm::dvec3& wanted) {
  const glm::dvec3 direction = directionOf({radiansFromDegrees(azimuthDeg), radiansFromDegrees(elevationDeg)});
  EXPECT_LT(glm::length(direction - wanted), 1e-15) << azimuthDeg << " " << elevationDeg;
  const Bearing back = bearingOf(3.0 * wanted);
  EXPECT_NEAR(degreesFromRadians(back.azimuthRad), azimuthDeg, 1e-12);
  EXPECT_NEAR(degreesFromRadians(back.elevationRad), elevationDeg, 1e-12);
}

TEST(Bearing, TurnsClockwiseFromNorth) {
  expectDirection(0, 0, {0, 1, 0});
  expectDirection(90, 0, {1, 0, 0});
  expectDirection(180, 0, {0, -1, 0});
  expectDirection(270, 0, {-1, 0, 0});
  expectDirection(45, 30, {std::sqrt(0.375), std::sqrt(0.375), 0.5});
  expectDirection(225, -30, {-std::sqrt(0.375), -std::sqrt(0.375), -0.5});
}

TEST(Bearing, HasNoSecondNorthAndAnAnswerForNoDirection) {
  EXPECT_EQ(bearingOf({-1e-300, 1, 0}).azimuthRad, 0);
  EXPECT_NEAR(bearingOf({0, 0, 0}).elevationRad, radiansFromDegrees(90), 1e-15);
}

}  // namespace
}  // namespace alidade
