// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A set that cannot fix the pose is refused with its reason, and the start stays.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sites.h"

namespace alidade {
namespace {

using testing::HasSubstr;

void expectRefused(const Site& site, const std::string& reason, const ResectionOptions& options = {}) {
  const auto summary = resect(site.camera, site.start, site.picks, options);
  ASSERT_TRUE(summary);
  EXPECT_FALSE(summary->converged);
  EXPECT_THAT(summary->reason, HasSubstr(reason));
  EXPECT_THAT(summary->report(), HasSubstr("refused"));
  EXPECT_EQ(std::isnan(site.start.translation.x), std::isnan(summary->cameraFromWorld.translation.x));
  if (site.start.isFinite()) {
    EXPECT_EQ(summary->cameraFromWorld.translation, site.start.translation);
    EXPECT_EQ(summary->cameraFromWorld.rotation, site.start.rotation);
  }
}

/// Replaces the world points, given in camera axes, and sees them from the truth with noise.
void see(Site& site, const std::vector<glm::dvec3>& inCamera, double noisePx, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const RigidTransform worldFromCamera = site.truth.inverse();
  site.picks.clear();
  for (const glm::dvec3& p : inCamera) {
    ResectionObservation pick;
    pick.world = worldFromCamera * p;
    pick.pixel = *site.camera.project(site.truth * pick.world) + noisePx * glm::dvec2(normal(random), normal(random));
    site.picks.push_back(pick);
  }
}

TEST(Degenerate, NumbersThatAreNoNumbers) {
  const Site good = randomSite(1, 10, 0.5);
  Site site = good;
  site.picks[3].pixel.x = std::nan("");
  expectRefused(site, "\"P4\" holds a coordinate that is not a finite number");
  site = good;
  site.picks[3].world.z = INFINITY;
  expectRefused(site, "not a finite number");
  site = good;
  site.picks[2].sigmaPx = 0;
  expectRefused(site, "must be positive");
  site = good;
  site.picks[2].sigmaPx = std::nan("");
  expectRefused(site, "must be positive");
  site = good;
  site.start.translation.x = std::nan("");
  expectRefused(site, "start pose is not a finite pose");
  site = good;
  site.camera = Camera();
  expectRefused(site, "calibration");
}

TEST(Degenerate, FewerPicksThanTheFreeParametersNeed) {
  Site site = randomSite(1, 0, 0.5);
  expectRefused(site, "0 observations for 6 free parameters");
  for (int n = 1; n <= 3; ++n) expectRefused(randomSite(1, n, 0.5), "at least 4 are needed");
  ResectionOptions attitudeAlone;
  attitudeAlone.lockPosition = {true, true, true};
  expectRefused(randomSite(1, 1, 0.5), "at least 2 are needed", attitudeAlone);
  // Two are enough for an attitude.
  Site two = randomSite(1, 2, 0.5);
  two.start = turnedBy(two.truth, {0.01, -0.02, 0.015}, {0, 0, 0});
  const auto summary = resect(two.camera, two.start, two.picks, attitudeAlone);
  ASSERT_TRUE(summary);
  EXPECT_TRUE(summary->converged) << summary->reason;
}

TEST(Degenerate, ThePickOfTheSamePointsAgainAndAgain) {
  Site site = randomSite(1, 3, 0.5);
  const auto three = site.picks;
  for (int i = 0; i < 5; ++i) site.picks.insert(site.picks.end(), three.begin(), three.end());
  expectRefused(site, "of 3 different points only");
}

TEST(Degenerate, AllPixelsInOneSpot) {
  Site site = randomSite(1, 0, 0.5);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 12; ++i) points.push_back((5.0 + 3 * i) * glm::dvec3(0.1 + 1e-5 * i, -0.05 + 2e-5 * (i % 3), 1));
  see(site, points, 0.2);
  expectRefused(site, "one spot");
}

TEST(Degenerate, WorldPointsOnOneLine) {
  for (const glm::dvec3 where : {glm::dvec3(0), glm::dvec3(100600, 196250, 6), glm::dvec3(1e7, 1e7, 0)}) {
    Site site = randomSite(1, 0, 0.5, where);
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 12; ++i) points.push_back(glm::dvec3(-6, 2, 12) + (i / 11.0) * glm::dvec3(12, -3, 9));
    see(site, points, 0.5);
    expectRefused(site, "collinear");
  }
}

TEST(Degenerate, WorldPointsAlmostOnOneLine) {
  Site site = randomSite(1, 0, 0.5);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 12; ++i)
    points.push_back(glm::dvec3(-6, 2, 12) + (i / 11.0) * glm::dvec3(12, -3, 9) + 0.01 * glm::dvec3(i % 2, i % 3, i % 5));
  see(site, points, 0.5);
  expectRefused(site, "undetermined");
}

TEST(Degenerate, EverythingBehindTheCamera) {
  Site site = randomSite(1, 12, 0.5);
  site.start = turnedBy(site.truth, {0, 3.14159265358979, 0}, {0, 0, 0});
  expectRefused(site, "behind the camera");
}

TEST(Degenerate, EverythingSoFarAwayThatThePositionIsOpen) {
  Site site = randomSite(1, 0, 0.5);
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<glm::dvec3> points;
  // Ten points of a village at five kilometres: twenty metres across, one degree of the picture.
  for (int i = 0; i < 10; ++i) points.emplace_back(40 * unit(random), 15 * unit(random), 5000 + 20 * unit(random));
  see(site, points, 0.5);
  site.start = turnedBy(site.truth, {1e-3, -1e-3, 2e-3}, {1, -1, 1});
  expectRefused(site, "undetermined");
  // Where it is known, the attitude is still to be had.
  site.start = turnedBy(site.truth, {1e-3, -1e-3, 0}, {0, 0, 0});
  ResectionOptions attitudeAlone;
  attitudeAlone.lockPosition = {true, true, true};
  const auto summary = resect(site.camera, site.start, site.picks, attitudeAlone);
  ASSERT_TRUE(summary);
  EXPECT_TRUE(summary->converged) << summary->reason;
}

TEST(Degenerate, MountainsAllOverThePictureTensOfKilometresOff) {
  Site site = randomSite(1, 0, 0.5);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 12; ++i) {
    const double z = 60000 + 30000 * unit(random);
    points.emplace_back(0.6 * z * unit(random), 0.3 * z * unit(random), z);
  }
  // A thousandth of their distance, far below a twentieth: 50 m.
  see(site, points, 0.5);
  site.start = site.truth;
  expectRefused(site, "The position is undetermined");
  for (glm::dvec3& p : points) p *= 1e-3;
  see(site, points, 0.5);
  const auto near = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(near);
  EXPECT_TRUE(near->converged) << near->reason;
}

std::vector<glm::dvec3> tiltedGrid(double size, double distance, double tilt) {
  std::vector<glm::dvec3> points;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j) {
      const double x = size * i, y = size * j;
      points.emplace_back(x * std::cos(tilt), y, distance + x * std::sin(tilt));
    }
  return points;
}

TEST(Degenerate, ASmallPlaneThatFitsTwoPoses) {
  Site site = randomSite(1, 0, 0.5);
  see(site, tiltedGrid(0.5, 60, 0.6), 0.5);
  for (auto& pick : site.picks) pick.sigmaPx = 0.5;
  site.start = turnedBy(site.truth, {0.002, -0.002, 0.003}, {0.05, -0.05, 0.02});
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary);
  EXPECT_FALSE(summary->converged);
  EXPECT_THAT(summary->reason, testing::AnyOf(HasSubstr("second pose"), HasSubstr("undetermined")));
}

TEST(Degenerate, AWideWallIsNoDegenerateSet) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Site site = randomSite(seed, 0, 0.5);
    see(site, tiltedGrid(5, 14, 0.5), 0.5, seed);
    const auto summary = resect(site.camera, site.start, site.picks);
    ASSERT_TRUE(summary);
    EXPECT_TRUE(summary->converged) << summary->reason;
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(summary->cameraFromWorld.centre()[i], site.truth.centre()[i], 5 * summary->positionStdM[i]);
  }
}

TEST(Degenerate, TheWrongOneOfTwoPosesIsLeftForTheBetter) {
  // Start at the mirrored pose of a wall that decides clearly between the two.
  Site site = randomSite(5, 0, 0.5);
  see(site, tiltedGrid(3, 14, 0.5), 0.3);
  const glm::dvec3 centroid(0, 0, 14);
  const RigidTransform worldFromCamera = site.truth.inverse();
  const glm::dquat turn = glm::angleAxis(2 * 0.5, glm::dvec3(0, 1, 0));
  site.start.rotation = turn * site.truth.rotation;
  site.start.translation = centroid - site.start.rotation * (worldFromCamera * centroid);
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary);
  if (summary->converged) {
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(summary->cameraFromWorld.centre()[i], site.truth.centre()[i], 5 * summary->positionStdM[i]);
  } else {
    EXPECT_THAT(summary->reason, HasSubstr("agree"));
  }
}

TEST(Degenerate, PicksThatBelongToNoPose) {
  Site site = randomSite(1, 20, 0.5);
  std::mt19937_64 random(77);
  std::uniform_real_distribution<double> unit(0, 1);
  for (auto& pick : site.picks) pick.pixel = {1920 * unit(random), 1080 * unit(random)};
  expectRefused(site, "agree with one pose");
}

}  // namespace
}  // namespace alidade
