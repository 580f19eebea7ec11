// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/refine_network.h"

namespace alidade {

namespace {

using testing::HasSubstr;

constexpr double kClockSecs = 0.08;
constexpr int kMoments = 8;

/// The first camera: forward at 1.5 m/s on a winding way, looking at a wall of points.
RigidTransform poseAt(double t) {
  const glm::dvec3 eye(1.5 * t, 0.8 * std::sin(1.3 * t), 1.6 + 0.2 * std::sin(2 * t));
  return RigidTransform::cameraLookingAt(eye, eye + glm::dvec3(std::sin(0.3 * std::sin(t)), std::cos(0.3 * std::sin(t)), 0.1 * std::sin(1.7 * t)));
}

RigidTransform mountTruth() {
  return {glm::normalize(glm::dquat(1, 0.01, -0.12, 0.02)), {-0.35, 0.02, 0.05}};
}

/// Two cameras on one body whose trajectory runs on another clock; the second one's mount is believed 4 cm and 0.7° off.
class RigSite {
 public:
  RigSite() {
    const RigidTransform believed{glm::normalize(glm::dquat(1, 0.016, -0.12, 0.02)) , {-0.32, 0.04, 0.03}};
    const Camera camera(*Intrinsics::fromParameters(CameraModel::Pinhole, 1280, 960, {900, 900, 639.5, 479.5}));
    for (int c = 0; c < 2; ++c) {
      project.cameras.push_back({CameraId{c + 1}, c == 0 ? "left" : "right", camera});
      std::vector<PoseSample> samples;
      for (int i = -20; i < 120; ++i) {
        const double t = 0.05 * i;
        samples.push_back({t, (c == 0 ? RigidTransform::identity() : believed) * poseAt(t - kClockSecs)});
      }
      Trajectory trajectory;
      trajectory.id = TrajectoryId{c + 1}, trajectory.name = c == 0 ? "left way" : "right way", trajectory.track = PoseTrack(std::move(samples));
      project.trajectories.push_back(std::move(trajectory));
    }
    for (int i = 0; i < kMoments; ++i)
      for (int c = 0; c < 2; ++c) {
        Frame frame;
        frame.id = FrameId{2 * i + c + 1};
        frame.name = fmt::format("{}{}", c == 0 ? "L" : "R", i);
        frame.timeSecs = 0.5 * i + (c == 0 ? 0 : 2e-4);
        frame.camera = CameraId{c + 1}, frame.trajectory = TrajectoryId{c + 1};
        truth.push_back((c == 0 ? RigidTransform::identity() : mountTruth()) * poseAt(0.5 * i));
        frame.cameraFromWorld = project.trajectories[static_cast<std::size_t>(c)].track.at(frame.timeSecs).cameraFromWorld;
        project.frames.push_back(frame);
      }
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int p = 0; p < 60; ++p) {
      const glm::dvec3 world(-3 + 12 * unit(random), 6 + 5 * unit(random), 4 * unit(random));
      for (std::size_t f = 0; f < truth.size(); ++f) {
        const auto pixel = camera.project(truth[f] * world);
        if (!pixel || !camera.inPicture(*pixel)) continue;
        ObservationRow row;
        row.frame = project.frames[f].name, row.name = fmt::format("P{}", p), row.where = "row";
        row.pixel = *pixel, row.world = world, row.sigmaPx = 0.2;
        rows.push_back(row);
      }
    }
  }

  Project project;
  std::vector<RigidTransform> truth;
  std::vector<ObservationRow> rows;
};

}  // namespace

TEST(RigNetwork, MountAndClockAreFoundTogether) {
  RigSite site;
  NetworkFreedom freedom;
  freedom.ties = {true, true, true, true};
  const auto made = networkOf(site.project, "", site.rows, freedom);
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->network.poses.size(), static_cast<std::size_t>(kMoments));
  EXPECT_EQ(made->network.frames.size(), 2u * kMoments);
  ASSERT_EQ(made->network.mounts.size(), 1u);
  ASSERT_EQ(made->network.trajectories.size(), 1u);
  const auto summary = refineNetwork(site.project, *made, {}, false, {});
  ASSERT_TRUE(summary) << summary.error().text();
  ASSERT_TRUE(summary->converged) << summary->reason;
  EXPECT_LT(glm::distance(summary->cameraFromBody[0].centre(), mountTruth().centre()), 1e-3);
  EXPECT_LT(rotationAngleBetween(summary->cameraFromBody[0], mountTruth()), 2e-4);
  EXPECT_GT(summary->mountAccuracy[0].offsetStdM.x, 0);
  EXPECT_NEAR(summary->clockOffsetSecs[0], kClockSecs, 2e-3);
  // Of a rig all cameras run on one clock.
  for (const Trajectory& trajectory : site.project.trajectories) {
    EXPECT_NEAR(trajectory.clockOffsetSecs, kClockSecs, 2e-3);
    EXPECT_TRUE(trajectory.clockOffsetStdSecs);
  }
  for (std::size_t f = 0; f < site.truth.size(); ++f)
    EXPECT_LT(glm::distance(site.project.frames[f].cameraFromWorld->centre(), site.truth[f].centre()), 5e-3) << site.project.frames[f].name;
  EXPECT_THAT(summary->report(made->network), HasSubstr("Mount right: at"));
}

TEST(RigNetwork, TheProjectKeepsItsRig) {
  RigSite site;
  NetworkFreedom freedom;
  freedom.ties.rig = freedom.ties.freeMounts = true;
  auto made = networkOf(site.project, "", site.rows, freedom);
  ASSERT_TRUE(made) << made.error().text();
  const auto summary = refineNetwork(site.project, *made, {}, false, {});
  ASSERT_TRUE(summary && summary->converged);
  ASSERT_TRUE(site.project.cameras[0].mount && site.project.cameras[1].mount);
  EXPECT_EQ(site.project.cameras[0].mount->body, "left") << "the camera that carries the other";
  const CameraMount kept = *site.project.cameras[1].mount;
  EXPECT_EQ(kept.body, "left");
  EXPECT_LT(glm::distance(kept.cameraFromBody.centre(), mountTruth().centre()), 1e-3);
  EXPECT_EQ(kept.offsetStdM, summary->mountAccuracy[0].offsetStdM);
  EXPECT_GT(kept.rotationStdRad.x, 0);

  // It holds from now on, whatever single poses say, and where no moment has two pictures.
  freedom.ties.freeMounts = false;
  for (Frame& frame : site.project.frames)
    if (frame.camera == CameraId{2}) frame.timeSecs += 0.2, frame.cameraFromWorld->translation.x += 0.3;
  made = networkOf(site.project, "", site.rows, freedom);
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->network.mounts[0].cameraFromBody.translation, kept.cameraFromBody.translation);
  EXPECT_EQ(made->network.poses.size(), 2u * kMoments);

  // On a sensor, cameras stay on it.
  const RigidTransform sensor{glm::normalize(glm::dquat(1, 0.1, 0.2, -0.1)), {0.05, 0.1, -0.2}};
  site = RigSite();
  site.project.cameras[0].mount = CameraMount{"IMU", sensor};
  site.project.cameras[1].mount = CameraMount{"IMU", mountTruth() * sensor};
  freedom.ties.freeMounts = true;
  made = networkOf(site.project, "", site.rows, freedom);
  ASSERT_TRUE(made);
  EXPECT_LT(glm::distance(made->network.mounts[0].cameraFromBody.translation, mountTruth().translation), 1e-12);
  ASSERT_TRUE(refineNetwork(site.project, *made, {}, false, {}));
  EXPECT_EQ(site.project.cameras[1].mount->body, "IMU");
  EXPECT_LT(glm::distance(site.project.cameras[1].mount->cameraFromBody.centre(), (mountTruth() * sensor).centre()), 1e-3);
}

TEST(RigNetwork, WhatIsLockedStaysAndTheResidualsShowIt) {
  const RigSite site;
  const auto solved = [&](const MotionTies& ties) {
    Project project = site.project;
    NetworkFreedom freedom;
    freedom.ties = ties;
    const auto made = networkOf(project, "", site.rows, freedom);
    EXPECT_TRUE(made) << made.error().text();
    NetworkOptions options;
    options.huberSigmas = 0;
    auto summary = refineNetwork(project, *made, options, false, {});
    EXPECT_TRUE(summary && summary->converged);
    if (made->network.mounts.size() == 1 && !ties.freeMounts) {
      EXPECT_EQ(summary->cameraFromBody[0].translation, made->network.mounts[0].cameraFromBody.translation);
    }
    if (!ties.freeClock) { EXPECT_EQ(project.trajectories[0].clockOffsetSecs, 0); }
    return summary->sigma0;
  };
  const double free = solved({true, true, true, true});
  EXPECT_LT(free, 0.5);
  EXPECT_GT(solved({true, false, true, true}), 5 * free) << "a wrong mount";
  EXPECT_GT(solved({true, true, true, false}), 5 * free) << "a wrong clock";
  // Not tied at all, every frame stands for itself.
  EXPECT_LT(solved({}), 0.5);
}

TEST(RigNetwork, AMomentThatTheFirstCameraMissedHasABodyToo) {
  RigSite site;
  std::erase_if(site.rows, [](const ObservationRow& row) { return row.frame == "L3"; });
  NetworkFreedom freedom;
  freedom.ties.rig = freedom.ties.freeMounts = true;
  const auto made = networkOf(site.project, "", site.rows, freedom);
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->network.poses.size(), static_cast<std::size_t>(kMoments));
  const auto summary = refineNetwork(site.project, *made, {}, false, {});
  ASSERT_TRUE(summary && summary->converged);
  const std::size_t missed = 2 * 3 + 1;
  ASSERT_EQ(site.project.frames[missed].name, "R3");
  EXPECT_LT(glm::distance(site.project.frames[missed].cameraFromWorld->centre(), site.truth[missed].centre()), 1e-3);
}

TEST(RigNetwork, WhatIsNoRigIsRefused) {
  RigSite site;
  NetworkFreedom freedom;
  freedom.ties.rig = true;
  std::vector<ObservationRow> left = site.rows;
  std::erase_if(left, [](const ObservationRow& row) { return row.frame.starts_with("R"); });
  auto made = networkOf(site.project, "", left, freedom);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().text(), HasSubstr("no rig"));
  Project apart = site.project;
  for (Frame& frame : apart.frames)
    if (frame.camera == CameraId{2}) frame.timeSecs += 0.2;
  made = networkOf(apart, "", site.rows, freedom);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().text(), HasSubstr("'right'"));
  ObservationRow position;
  position.kind = ObservationKind::Position, position.frame = "R1", position.where = "row", position.world = glm::dvec3(0), position.sigmaM = 0.01;
  site.rows.push_back(position);
  made = networkOf(site.project, "", site.rows, freedom);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().text(), HasSubstr("sits on a rig"));
  freedom.ties = {};
  freedom.ties.trajectory = true;
  for (Frame& frame : apart.frames) frame.trajectory = {};
  made = networkOf(apart, "", left, freedom);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().text(), HasSubstr("trajectory"));
}

}  // namespace alidade
