// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/pose_estimate.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/align/room.h"
#include "unit/align/starts.h"

namespace alidade {

namespace {

using test::Room;

/// A grid of places on the room's walls, as the camera sees them, with noise.
std::vector<SeenPlace> places(double sigmaPx, std::mt19937& random) {
  const Camera camera = Room::camera();
  const RigidTransform pose = Room::pose(), back = pose.inverse();
  std::normal_distribution<double> noise(0, sigmaPx);
  std::vector<SeenPlace> seen;
  for (int y = 20; y < 480; y += 40)
    for (int x = 20; x < 640; x += 40) {
      const glm::dvec3 along = glm::transpose(pose.rotationMatrix()) * *camera.unproject({x, y});
      const auto hit = Room::hit(pose.centre() - Room::world({0, 0, 0}), along);
      if (!hit) continue;
      SeenPlace place;
      place.world = back.translation + hit->second * along;
      place.pixel = {x + noise(random), y + noise(random)};
      place.information = glm::dmat2(1 / (sigmaPx * sigmaPx));
      place.block = y / 120 * 6 + x / 107;
      seen.push_back(place);
    }
  return seen;
}

}  // namespace

TEST(PoseEstimate, FindsTheExactPoseAmongAThirdOfWrongPlaces) {
  std::mt19937 random(1);
  auto seen = places(1e-6, random);
  for (std::size_t i = 0; i < seen.size(); i += 3) seen[i].pixel += glm::dvec2(15, -9), seen[i].information = glm::dmat2(100);
  for (SeenPlace& place : seen) place.information = glm::dmat2(100);
  const auto found = estimatePose(Room::camera(), test::disturbed(Room::pose(), random, 0.02, 0.2), seen);
  ASSERT_TRUE(found);
  EXPECT_LT(glm::distance(found->cameraFromWorld.centre(), Room::pose().centre()), 2e-3);
  EXPECT_LT(rotationAngleBetween(found->cameraFromWorld, Room::pose()), 5e-4);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(found->weights[i] >= 0.5, i % 3 != 0) << i;
}

TEST(PoseEstimate, ItsStandardDeviationIsThatOfManyTrials) {
  std::mt19937 random(2);
  glm::dvec3 squares(0), claimed(0);
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    const auto found = estimatePose(Room::camera(), Room::pose(), places(0.4, random));
    ASSERT_TRUE(found);
    const glm::dvec3 off = found->cameraFromWorld.centre() - Room::pose().centre();
    squares += off * off, claimed += found->positionStdM * found->positionStdM;
  }
  for (int i = 0; i < 3; ++i) {
    // Both the spread of the blocks and the places' own noise are counted: at most √2 and a little too much.
    const double ratio = std::sqrt(claimed[i] / squares[i]);
    EXPECT_GT(ratio, 0.9) << i;
    EXPECT_LT(ratio, 1.8) << i;
  }
}

TEST(PoseEstimate, LockedParametersStay) {
  std::mt19937 random(3);
  const RigidTransform start = test::disturbed(Room::pose(), random, 0.03, 0.3);
  PoseKnowledge known;
  known.locked = {true, true, true, false, false, false};
  const auto found = estimatePose(Room::camera(), start, places(0.1, random), known);
  ASSERT_TRUE(found);
  EXPECT_LT(glm::distance(found->cameraFromWorld.centre(), start.centre()), 1e-7);  // what a double holds at survey coordinates
  EXPECT_GT(rotationAngleBetween(found->cameraFromWorld, start), 1e-5);
}

TEST(PoseEstimate, PlacesInOneCornerGiveNoPose) {
  std::mt19937 random(4);
  auto seen = places(0.3, random);
  std::erase_if(seen, [](const SeenPlace& place) { return place.block > 1; });
  EXPECT_FALSE(estimatePose(Room::camera(), Room::pose(), seen));
  EXPECT_FALSE(estimatePose(Room::camera(), Room::pose(), {}));
}

}  // namespace alidade
