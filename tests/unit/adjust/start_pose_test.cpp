// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/start_pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sites.h"

namespace alidade {
namespace {

TEST(StartPose, ThreePointsGiveTheTrueOneAmongAtMostFour) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    const Site site = randomSite(seed, 3, 0);
    std::array<glm::dvec3, 3> rays, world;
    for (int i = 0; i < 3; ++i) {
      rays[i] = glm::normalize(*site.camera.unproject(site.picks[i].pixel));
      world[i] = site.picks[i].world;
    }
    const auto poses = posesFromThreePoints(rays, world);
    ASSERT_LE(poses.size(), 4u);
    double nearest = 1e9;
    for (const RigidTransform& pose : poses) {
      nearest = std::min(nearest, glm::length(pose.centre() - site.truth.centre()));
      for (int i = 0; i < 3; ++i)
        EXPECT_LT(glm::length(glm::normalize(pose * world[i]) - rays[i]), 1e-4) << seed;
    }
    EXPECT_LT(nearest, 1e-3) << seed;
  }
}

TEST(StartPose, IsFoundFromNothingThoughHalfThePicksAreWrong) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    Site site = randomSite(seed, 30, 0.5, {2.6e6, 1.2e6, 400});
    std::mt19937_64 random(seed);
    for (int i = 0; i < 15; ++i) site.picks[i].pixel = {static_cast<double>(random() % 1920), static_cast<double>(random() % 1080)};
    const auto pose = findStartPose(site.camera, site.picks);
    ASSERT_TRUE(pose) << seed << pose.error().text();
    EXPECT_LT(glm::length(pose->centre() - site.truth.centre()), 0.2) << seed;
  }
}

TEST(StartPose, SaysWhyThereIsNone) {
  Site site = randomSite(1, 3, 0.5);
  EXPECT_THAT(findStartPose(site.camera, site.picks).error().text(), testing::HasSubstr("at least 4"));
  site = randomSite(1, 8, 0.5);
  for (int i = 0; i < 8; ++i) site.picks[i].world = {1.0 * i, 2.0 * i, 0.5 * i};
  EXPECT_THAT(findStartPose(site.camera, site.picks).error().text(), testing::HasSubstr("line"));
}

}  // namespace
}  // namespace alidade
