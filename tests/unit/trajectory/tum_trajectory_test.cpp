// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/tum_trajectory_reader.h"

#include <filesystem>
#include <map>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

using testing::HasSubstr;

namespace {

Result<CameraSet> parsed(const std::string& text) { return parseTumTrajectory(text, "t.txt", Progress()); }

int sniffed(const std::string& text, const std::string& extension = "txt") {
  FileProbe probe;
  probe.path = "t." + extension;
  probe.extension = extension;
  probe.head = std::as_bytes(std::span(text.data(), text.size()));
  return TumTrajectoryReader().sniff(probe);
}

}  // namespace

TEST(TumTrajectory, TurnsCameraToWorldAround) {
  // A quarter turn about z: the camera's x is the world's y. The camera stands at (10, 20, 30).
  const auto set = parsed("# remark\n1.5 10 20 30 0 0 0.70710678118654752 0.70710678118654752\n");
  ASSERT_TRUE(set) << set.error().text();
  const PosedPicture& pose = set->pictures.at(0);
  EXPECT_TRUE(pose.hasTime);
  EXPECT_EQ(pose.timeSecs, 1.5);
  EXPECT_LT(glm::length(pose.cameraFromWorld->centre() - glm::dvec3(10, 20, 30)), 1e-12);
  const glm::dvec3 pInCamera = *pose.cameraFromWorld * glm::dvec3(10, 21, 30);
  EXPECT_LT(glm::length(pInCamera - glm::dvec3(1, 0, 0)), 1e-12);
}

TEST(TumTrajectory, SortsTimesAndSaysSo) {
  const auto set = parsed("2 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 2\n");
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures[0].timeSecs, 1);
  EXPECT_EQ(set->pictures[2].timeSecs, 2);
  ASSERT_EQ(set->warnings.size(), 3u);  // order, time twice, quaternion's length
  EXPECT_THAT(set->warnings[0].where, HasSubstr("line 2"));
  EXPECT_EQ(set->pictures[1].cameraFromWorld->rotation.w, 1);
}

TEST(TumTrajectory, RefusesBrokenLinesByNumber) {
  for (const char* line : {"1 0 0 0 0 0 0", "1 0 0 0 0 0 0 1 5", "1 0 0 nan 0 0 0 1", "inf 0 0 0 0 0 0 1", "1 0 0 0 0 0 0 0",
                           "1 1e300 0 0 0 0 0 1", "1 0 0 0 0 0 0 1e999", "one 0 0 0 0 0 0 1", "1,0,0,0,0,0,0,1"}) {
    const auto set = parsed(std::string("# x\n0 0 0 0 0 0 0 1\n") + line + "\n");
    ASSERT_FALSE(set) << line;
    EXPECT_EQ(set.error().where, "t.txt, line 3") << line;
  }
  EXPECT_FALSE(parsed(""));
  EXPECT_FALSE(parsed("# nothing\n\n"));
}

TEST(TumTrajectory, SurvivesRandomDamage) {
  std::mt19937 random(2);
  for (int i = 0; i < 5000; ++i) {
    std::string text = "# a\n1 2 3 4 0 0 0 1\n2 2 3 4 0.5 0.5 0.5 0.5\n";
    for (int k = 0; k < 3; ++k) text[random() % text.size()] = "0123456789 .-+einf#\n\xff"[random() % 21];
    (void)parsed(text);
    (void)sniffed(text);
  }
}

TEST(TumTrajectory, ClaimsOnlyUnitQuaternions) {
  EXPECT_GE(sniffed("# t\n1 0 0 0 0 0 0 1\n"), 50);
  EXPECT_EQ(sniffed("1 2 3 4 5 6 7 8\n"), 0) << "eight numbers of another kind";
  EXPECT_EQ(sniffed("1 2 3\n"), 0);
  EXPECT_EQ(sniffed("P1,1,2,3\n"), 0);
}

TEST(TumTrajectory, AgreesWithTheColmapPosesOfTheSameVideo) {
  const std::string folder = std::string(ALIDADE_SHARED_DATA_DIR) + "/indoor_video";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "needs " << folder;
  const auto set = TumTrajectoryReader().read(folder + "/trajectory_tum.txt", Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures.size(), 373u);
  EXPECT_TRUE(set->warnings.empty());
  // images/00003.png in sparse/images.txt, camera from world.
  const RigidTransform expected{glm::dquat(-0.150951310259, 0.793429747283, -0.122476201204, 0.576786371368),
                                {-3.862332826, -1.071986498, 3.102245309}};
  const auto first = std::find_if(set->pictures.begin(), set->pictures.end(),
                                  [](const PosedPicture& p) { return std::abs(p.timeSecs - 0.1) < 1e-6; });
  ASSERT_NE(first, set->pictures.end());
  EXPECT_LT(rotationAngleBetween(*first->cameraFromWorld, expected), 1e-5);
  EXPECT_LT(glm::length(first->cameraFromWorld->centre() - glm::dvec3(-1.94312, 0.112344, 4.67999)), 1e-9);
}

}  // namespace alidade
