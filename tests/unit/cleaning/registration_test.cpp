// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cleaning/registration.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>

using namespace alidade;
using ::testing::HasSubstr;

namespace {

const glm::dvec3 kSurvey(2683500, 1247800, 412);

/// Points on a floor, two walls and a pillar: what a room leaves open in no direction.
std::vector<glm::dvec3> room(unsigned seed, double noise, double from = 0, double to = 10) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(from, to), across(0, 8), up(0, 3);
  std::normal_distribution<double> off(0, noise);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 20000; ++i) points.push_back({along(random), across(random), off(random)});
  for (int i = 0; i < 8000; ++i) points.push_back({along(random), off(random), up(random)});
  for (int i = 0; i < 8000; ++i) points.push_back({5 + off(random), across(random), up(random)});
  return points;
}

RigidTransform known(double degrees, const glm::dvec3& shift) {
  RigidTransform transform;
  transform.rotation = glm::angleAxis(glm::radians(degrees), glm::normalize(glm::dvec3(0.2, -0.3, 1)));
  const glm::dvec3 middle = kSurvey + glm::dvec3(5, 4, 1);
  transform.translation = middle + shift - transform.rotation * middle;
  return transform;
}

std::vector<glm::dvec3> inSurvey(std::vector<glm::dvec3> points, const RigidTransform& transform) {
  for (auto& p : points) p = transform * (p + kSurvey);
  return points;
}

}  // namespace

TEST(Registration, FindsAKnownTransformInSurveyCoordinates) {
  const RigidTransform truth = known(1.5, {0.12, -0.08, 0.05});
  const auto fixed = inSurvey(room(1, 0.002), RigidTransform::identity());
  const auto moving = inSurvey(room(2, 0.002), truth.inverse());
  const auto found = registerScan(moving, fixed, {}, Progress());
  ASSERT_TRUE(found) << found.error().text();
  // Different points of the same surfaces, 2 mm of noise in both: 36 000 pairs leave some hundredths of a millimetre.
  for (const glm::dvec3 corner : {glm::dvec3(0, 0, 0), glm::dvec3(10, 8, 0), glm::dvec3(0, 8, 3), glm::dvec3(10, 0, 3)})
    EXPECT_LT(glm::length(found->fixedFromMoving * (truth.inverse() * (kSurvey + corner)) - (kSurvey + corner)), 0.0005);
  // About the middle of the moving scan, whose turn leaves the shift nearly alone.
  EXPECT_LT(glm::length(found->shiftMeters - glm::dvec3(0.12, -0.08, 0.05)), 0.05);
  EXPECT_NEAR(found->rmsPlaneMeters, 0.002 * std::sqrt(2.0), 0.001);
  EXPECT_GT(found->share, 0.95);
  EXPECT_THAT(found->report(), HasSubstr("pairs"));
}

TEST(Registration, PartialOverlapIsFittedAndCounted) {
  const RigidTransform truth = known(0.5, {0.05, 0.05, -0.03});
  const auto fixed = inSurvey(room(3, 0.001, 0, 7), RigidTransform::identity());
  const auto moving = inSurvey(room(4, 0.001, 3, 10), truth.inverse());
  const auto found = registerScan(moving, fixed, {}, Progress());
  ASSERT_TRUE(found) << found.error().text();
  const glm::dvec3 p = kSurvey + glm::dvec3(5, 4, 1);
  EXPECT_LT(glm::length(found->fixedFromMoving * (truth.inverse() * p) - p), 0.001);
  // 4 of 7 metres of floor and wall are shared, the cross wall wholly.
  EXPECT_NEAR(found->share, (28000 * 4.0 / 7 + 8000) / 36000, 0.06);
}

TEST(Registration, WhatCannotBeFittedIsRefusedWithItsReason) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> at(0, 10);
  std::vector<glm::dvec3> floor, other;
  for (int i = 0; i < 5000; ++i) floor.push_back({at(random), at(random), 0}), other.push_back({at(random), at(random), 0.05});
  EXPECT_THAT(registerScan(other, floor, {}, Progress()).error().what, HasSubstr("leave a direction open"));
  const auto here = room(6, 0.002);
  auto away = room(7, 0.002);
  for (auto& p : away) p += glm::dvec3(100, 0, 0);
  EXPECT_THAT(registerScan(away, here, {}, Progress()).error().what, HasSubstr("find a partner"));
  auto near = room(7, 0.002);
  for (auto& p : near) p += glm::dvec3(0.1, 0.1, 0.1);
  EXPECT_THAT(registerScan(near, here, {.iterations = 1}, Progress()).error().what, HasSubstr("did not converge in 1 steps"));
  EXPECT_THAT(registerScan(std::vector<glm::dvec3>(5), here, {}, Progress()).error().what, HasSubstr("5 and"));
  EXPECT_FALSE(registerScan(here, here, {.reachMeters = 0}, Progress()));
  Progress cancelled;
  cancelled.cancel();
  EXPECT_TRUE(isCancelled(registerScan(here, here, {}, cancelled).error()));
}
