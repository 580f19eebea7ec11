// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/trajectory.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace alidade {

namespace {

/// A camera on a constant screw: circles a vertical axis at 0.4 rad/s and rises at 0.2 m/s, looking at the axis.
RigidTransform onScrew(double t) {
  const glm::dvec3 eye(600 + 5 * std::cos(0.4 * t), 200 + 5 * std::sin(0.4 * t), 2 + 0.2 * t);
  return RigidTransform::cameraLookingAt(eye, {600, 200, eye.z});
}

PoseTrack screwTrack(double from, double to, double step) {
  std::vector<PoseSample> samples;
  for (int i = 0; from + i * step <= to + 1e-9; ++i) samples.push_back({from + i * step, onScrew(from + i * step)});
  return PoseTrack(samples);
}

}  // namespace

TEST(PoseTrack, APoseBetweenSamplesIsOnTheScrew) {
  const PoseTrack track = screwTrack(0, 4, 0.5);
  for (const double t : {0.0, 0.1, 0.25, 1.7, 3.99, 4.0}) {
    const auto pose = track.at(t).cameraFromWorld;
    ASSERT_TRUE(pose) << t;
    EXPECT_LT(glm::length(pose->centre() - onScrew(t).centre()), 1e-9) << t;
    EXPECT_LT(rotationAngleBetween(*pose, onScrew(t)), 1e-9) << t;
  }
}

TEST(PoseTrack, NothingIsMadeUpBeyondTheEndsOrAcrossAnInterruption) {
  std::vector<PoseSample> samples = screwTrack(10, 12, 0.1).samples();
  const PoseTrack late = screwTrack(15, 16, 0.1);
  samples.insert(samples.end(), late.samples().begin(), late.samples().end());
  const PoseTrack track(samples);
  EXPECT_NEAR(track.medianStepSecs(), 0.1, 1e-9);
  const std::pair<double, PoseGap> gaps[] = {{9.9, PoseGap::BeforeStart}, {16.1, PoseGap::AfterEnd}, {13, PoseGap::Interrupted},
                                             {12.01, PoseGap::Interrupted}, {-1e300, PoseGap::BeforeStart}};
  for (const auto& [time, gap] : gaps) {
    const auto answer = track.at(time);
    EXPECT_FALSE(answer.cameraFromWorld) << time;
    EXPECT_EQ(answer.gap, gap) << time;
    EXPECT_FALSE(poseGapText(answer.gap).empty());
  }
  EXPECT_TRUE(track.at(12).cameraFromWorld) << "the last before the interruption";
  EXPECT_TRUE(track.at(15).cameraFromWorld);
  EXPECT_FALSE(PoseTrack().at(0).cameraFromWorld);
  EXPECT_FALSE(track.at(std::numeric_limits<double>::quiet_NaN()).cameraFromWorld);
}

TEST(PoseTrack, UnsortedDoubleAndBrokenSamplesAreSorted) {
  RigidTransform broken = onScrew(1);
  broken.translation.x = std::nan("");
  const PoseTrack track({{2, onScrew(2)}, {0, onScrew(9)}, {1, broken}, {0, onScrew(0)}, {1, onScrew(1)}, {std::nan(""), onScrew(1)}});
  ASSERT_EQ(track.samples().size(), 3u);
  EXPECT_EQ(track.samples()[0].timeSecs, 0);
  EXPECT_LT(glm::length(track.at(0).cameraFromWorld->centre() - onScrew(0).centre()), 1e-12) << "of two of one time the last stays";
}

TEST(PoseTrack, ItsMotionIsTheScrewsVelocity) {
  const PoseTrack track = screwTrack(0, 4, 0.25);
  const glm::dvec3 world(601, 199, 3);
  for (const double t : {0.0, 1.1, 4.0}) {
    const auto motion = track.motionAt(t, 0.02);
    ASSERT_TRUE(motion) << t;
    // How a still point moves through the camera's axes, by differences of the closed form.
    const glm::dvec3 velocity = (onScrew(t + 1e-5) * world - onScrew(t - 1e-5) * world) / 2e-5;
    EXPECT_LT(glm::length(motion->velocityOf(onScrew(t) * world) - velocity), 1e-5) << t;
  }
  EXPECT_FALSE(track.motionAt(7, 0.02));
  EXPECT_FALSE(track.motionAt(1, 0));
}

}  // namespace alidade
