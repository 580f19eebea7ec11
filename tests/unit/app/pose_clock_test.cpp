// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/pose_clock.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/pose_matching.h"
#include "app/workspace.h"

namespace alidade {

namespace {

/// Straight ahead at 2 m/s, turning at 0.1 rad/s.
RigidTransform poseAt(double t) {
  return RigidTransform::cameraLookingAt({2 * t, 0, 1.6}, {2 * t + std::sin(0.1 * t), std::cos(0.1 * t), 1.6});
}

CameraSource trackedFrom(double from, double to, double clock) {
  CameraSource source{"/data/track.txt", {}};
  for (int i = 0; from + 0.1 * i <= to + 1e-9; ++i)
    source.set.pictures.push_back({"", from + 0.1 * i + clock, true, -1, poseAt(from + 0.1 * i)});
  return source;
}

/// Frames of a video at 10.3 Hz, which no pose falls on.
Project videoProject(int frames) {
  Project project;
  project.videos.push_back({VideoId{1}, "v", {}, 10.3, frames});
  for (int i = 0; i < frames; ++i) {
    Frame frame;
    frame.id = FrameId{i + 1};
    frame.name = "frame " + std::to_string(i);
    frame.video = VideoId{1};
    frame.videoFrame = i;
    frame.timeSecs = i / 10.3;
    project.frames.push_back(frame);
  }
  project.cameras.push_back({CameraId{1}, "c", Camera(*Intrinsics::fromParameters(CameraModel::Pinhole, 640, 480, {500, 500, 319.5, 239.5}))});
  for (Frame& frame : project.frames) frame.camera = CameraId{1};
  return project;
}

/// Within a tenth of a second the turning walk is off the screw between two samples by up to 0.3 mm.
constexpr double kScrewM = 5e-4;

double offBy(const Frame& frame, double t) {
  return glm::length(frame.cameraFromWorld->centre() - poseAt(t).centre());
}

}  // namespace

TEST(PoseClock, AnOffsetMovesEveryPoseAlongTheTrajectory) {
  Project project = videoProject(50);
  matchPoses(project, {trackedFrom(0, 6, 0)});
  ASSERT_EQ(project.trajectories.size(), 1u);
  const TrajectoryId id = project.trajectories[0].id;
  EXPECT_LT(offBy(project.frames[30], 30 / 10.3), kScrewM);
  EXPECT_EQ(project.frames[30].poseSource, PoseSource::Interpolated);
  const auto count = setClockOffset(project, id, 0.25, 0.001);
  ASSERT_TRUE(count);
  EXPECT_EQ(count->posed, 50u);
  EXPECT_LT(offBy(project.frames[30], 30 / 10.3 + 0.25), kScrewM);
  EXPECT_EQ(project.trajectories[0].clockOffsetStdSecs, 0.001);
  EXPECT_FALSE(setClockOffset(project, id, std::nan("")));
  for (const double never : {1e300, -1e300, 6.1, -5.1}) {
    const auto refused = setClockOffset(project, id, never);
    ASSERT_FALSE(refused) << never;
    EXPECT_THAT(refused.error().text(), testing::HasSubstr("between -4.757 and 6.000 s"));
  }
  EXPECT_EQ(project.trajectories[0].clockOffsetSecs, 0.25) << "a refusal changes nothing";
  EXPECT_LT(offBy(project.frames[30], 30 / 10.3 + 0.25), kScrewM);
  EXPECT_FALSE(setClockOffset(project, TrajectoryId{99}, 0));
}

TEST(PoseClock, FramesThatTheTrajectoryDoesNotCoverHaveNoPoseAndAreCounted) {
  Project project = videoProject(50);
  matchPoses(project, {trackedFrom(0, 6, 0)});
  const TrajectoryId id = project.trajectories[0].id;
  const auto count = setClockOffset(project, id, 2.0);
  ASSERT_TRUE(count);
  EXPECT_LT(count->posed, 50u);
  EXPECT_EQ(count->posed + count->without.at(PoseGap::AfterEnd), 50u);
  EXPECT_THAT(poseCountText(*count), testing::HasSubstr("after the trajectory ends"));
  EXPECT_FALSE(project.frames.back().cameraFromWorld);
  EXPECT_EQ(project.frames.back().poseSource, PoseSource::None);
  // And back again.
  EXPECT_EQ(setClockOffset(project, id, 0)->posed, 50u);
  EXPECT_LT(offBy(project.frames.back(), 49 / 10.3), kScrewM);
}

TEST(PoseClock, ARefinedPoseStays) {
  Project project = videoProject(20);
  matchPoses(project, {trackedFrom(0, 6, 0)});
  Frame& refined = project.frames[5];
  refined.cameraFromWorld = RigidTransform::cameraLookingAt({7, 7, 7}, {8, 8, 8});
  refined.poseSource = PoseSource::Refined;
  setClockOffset(project, project.trajectories[0].id, 0.3);
  EXPECT_LT(glm::length(project.frames[5].cameraFromWorld->centre() - glm::dvec3(7, 7, 7)), 1e-12);
}

TEST(PoseClock, ClocksThatNeverMeetAreLaidStartOnStartAndItIsSaid) {
  Project project = videoProject(40);
  const auto notes = matchPoses(project, {trackedFrom(0, 6, 1.7e9)});
  ASSERT_EQ(project.trajectories.size(), 1u);
  EXPECT_NEAR(project.trajectories[0].clockOffsetSecs, 1.7e9, 1e-6);
  EXPECT_THAT(notes, testing::Contains(testing::HasSubstr("Estimate the clock offset")));
  EXPECT_LT(offBy(project.frames[20], 20 / 10.3), 1e-3);
}

TEST(PoseClock, ATrajectoryIsFoundByNameOrAsTheOnlyOne) {
  Project project = videoProject(20);
  EXPECT_THAT(trajectoryByName(project, "").error().what, testing::HasSubstr("no trajectory"));
  matchPoses(project, {trackedFrom(0, 6, 0)});
  EXPECT_TRUE(trajectoryByName(project, ""));
  EXPECT_TRUE(trajectoryByName(project, "track"));
  EXPECT_THAT(trajectoryByName(project, "x").error().advice, testing::HasSubstr("'track'"));
}

TEST(PoseClock, TheShutterMovesAsTheTrajectoryDoes) {
  Project project = videoProject(20);
  matchPoses(project, {trackedFrom(0, 6, 0)});
  EXPECT_FALSE(shutterOf(project, project.frames[8]).isOn()) << "a global shutter";
  project.cameras[0].readoutSecs = 0.02;
  const RollingShutter tracked = shutterOf(project, project.frames[8]);
  ASSERT_TRUE(tracked.isOn());
  EXPECT_EQ(tracked.readoutSecs, 0.02);
  const double t = project.frames[8].timeSecs;
  const glm::dvec3 world(3, 5, 2);
  const glm::dvec3 velocity = (poseAt(t + 1e-5) * world - poseAt(t - 1e-5) * world) / 2e-5;
  EXPECT_LT(glm::length(tracked.motion.velocityOf(poseAt(t) * world) - velocity), 1e-2);
  // Without a trajectory the frames around tell.
  for (Frame& frame : project.frames) frame.trajectory = {};
  const RollingShutter between = shutterOf(project, project.frames[8]);
  ASSERT_TRUE(between.isOn());
  EXPECT_LT(glm::length(between.motion.velocityOf(poseAt(t) * world) - velocity), 2e-2);
}

TEST(PoseClock, AFrameOfAnotherSizeOrWithoutAPoseIsRefusedByName) {
  Project project = videoProject(20);
  const auto poseless = describeFrame(project, {}, project.frames[3].id, nullptr);
  EXPECT_THAT(poseless.error().what, testing::HasSubstr("has no pose"));
  EXPECT_TRUE(describeFrame(project, {}, project.frames[3].id, nullptr, {}, poseAt(1))) << "a pose to be judged stands in";
  matchPoses(project, {trackedFrom(0, 6, 0)});
  const auto wrong = describeFrame(project, {}, project.frames[3].id, std::make_shared<ColourImage>(320, 240));
  EXPECT_THAT(wrong.error().what, testing::HasSubstr("320 × 240"));
}

}  // namespace alidade
