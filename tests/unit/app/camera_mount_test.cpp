// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/camera_mount.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace alidade {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

/// A body that stands 10 m up, its axes the world's, and moves east by 1 m a second; camera 1's frames have poses on its
/// trajectory, which is the body's.
Project onABody() {
  Project project;
  project.cameras = {{CameraId{1}, "left", Camera()}, {CameraId{2}, "right", Camera()}};
  Trajectory way;
  way.id = {5};
  way.name = "way";
  std::vector<PoseSample> samples;
  for (int i = 0; i < 5; ++i) samples.push_back({double(i), RigidTransform{glm::dquat(1, 0, 0, 0), {100.0 + i, 200, 10}}.inverse()});
  way.track = PoseTrack(std::move(samples));
  project.trajectories = {way};
  for (int i = 0; i < 3; ++i) {
    Frame frame;
    frame.id = {i + 1};
    frame.timeSecs = i + 0.5;
    frame.camera = {1};
    frame.trajectory = {5};
    frame.cameraFromWorld = way.track.at(frame.timeSecs).cameraFromWorld;
    frame.poseSource = PoseSource::Interpolated;
    project.frames.push_back(frame);
  }
  return project;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-12) {
  EXPECT_LT(glm::length(a - b), tolerance) << a.x << " " << a.y << " " << a.z;
}

}  // namespace

TEST(CameraMount, FiguresSayWhereTheCameraSitsAndHowItIsTurned) {
  // Turned by 90° about the body's x: what is forward for the camera (z) is right against the body's y.
  const auto mount = mountOf({"body", {0.1, -0.2, 0.3}, {kQuarter, 0, 0}});
  ASSERT_TRUE(mount) << mount.error().text();
  const RigidTransform bodyFromCamera = mount->cameraFromBody.inverse();
  expectNear(bodyFromCamera * glm::dvec3(0), {0.1, -0.2, 0.3});
  expectNear(bodyFromCamera.rotation * glm::dvec3(0, 0, 1), {0, -1, 0});
  expectNear(bodyFromCamera.rotation * glm::dvec3(1, 0, 0), {1, 0, 0});
  const auto turned = mountOf({"body", {0, 0, 0}, {0.3, -0.4, 2.5}, {0.001, 0.002, 0.003}, {1e-4, 2e-4, 3e-4}});
  const MountFigures back = figuresOf(*turned);
  expectNear(back.anglesRad, {0.3, -0.4, 2.5});
  expectNear(back.positionStdM, {0.001, 0.002, 0.003});
  expectNear(back.anglesStdRad, {1e-4, 2e-4, 3e-4});
  expectNear(figuresOf({"body", RigidTransform::identity()}).anglesRad, {0, 0, 0});
}

TEST(CameraMount, RefusesWhatIsNoMount) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(mountOf({" ", {}, {}}).error().what.find("no body"), std::string::npos);
  EXPECT_NE(mountOf({"b", {nan, 0, 0}, {}}).error().what.find("finite"), std::string::npos);
  EXPECT_NE(mountOf({"b", {0, 0, 0}, {0, nan, 0}}).error().what.find("finite"), std::string::npos);
  EXPECT_NE(mountOf({"b", {2683512, 0, 0}, {}}).error().what.find("2683512 m"), std::string::npos);
  EXPECT_NE(mountOf({"b", {}, {}, {0, -0.001, 0}, {}}).error().what.find("negative"), std::string::npos);
  Project project = onABody();
  EXPECT_FALSE(setMount(project, CameraId{9}, std::nullopt));
}

TEST(CameraMount, ThePosesOnItsTrajectoryFollowTheCamera) {
  Project project = onABody();
  const RigidTransform refined = *project.frames[2].cameraFromWorld;
  project.frames[2].poseSource = PoseSource::Refined;
  const auto followed = setMount(project, CameraId{1}, *mountOf({"car", {0.5, 0, -1}, {0, 0, kQuarter}}));
  ASSERT_TRUE(followed) << followed.error().text();
  EXPECT_EQ(*followed, 2) << "all but the refined one";
  expectNear(project.frames[0].cameraFromWorld->centre(), {101.0, 200, 9});
  expectNear(project.frames[1].cameraFromWorld->centre(), {102.0, 200, 9});
  // x of the camera is y of the body.
  expectNear(project.frames[0].cameraFromWorld->inverse().rotation * glm::dvec3(1, 0, 0), {0, 1, 0});
  EXPECT_EQ(project.frames[2].cameraFromWorld->translation, refined.translation) << "what was refined is known better";
  // Elsewhere: from the body again, not from where it was.
  ASSERT_TRUE(setMount(project, CameraId{1}, *mountOf({"car", {0, 2, 0}, {0, 0, 0}})));
  expectNear(project.frames[0].cameraFromWorld->centre(), {100.5, 202, 10});
  ASSERT_TRUE(setMount(project, CameraId{1}, std::nullopt));
  expectNear(project.frames[0].cameraFromWorld->centre(), {100.5, 200, 10});
  EXPECT_FALSE(project.cameras[0].mount);
}

TEST(CameraMount, WhatWasCorrectedBetweenKeyframesStaysCorrected) {
  Project project = onABody();
  Frame& frame = project.frames[0];
  ASSERT_EQ(frame.poseSource, PoseSource::Interpolated);
  frame.originalCameraFromWorld = frame.cameraFromWorld;
  const RigidTransform correction{glm::angleAxis(0.01, glm::dvec3(0, 0, 1)), {0.02, -0.01, 0.03}};
  frame.cameraFromWorld = correction * *frame.cameraFromWorld;
  const RigidTransform wasInBody = *frame.cameraFromWorld;
  ASSERT_TRUE(setMount(project, CameraId{1}, *mountOf({"car", {0.5, 0, -1}, {0, 0, 0.3}})));
  const RigidTransform& mount = project.cameras[0].mount->cameraFromBody;
  expectNear(project.frames[0].cameraFromWorld->translation, (mount * wasInBody).translation);
  expectNear(project.frames[0].originalCameraFromWorld->translation, (mount * correction.inverse() * wasInBody).translation);
  ASSERT_TRUE(setMount(project, CameraId{1}, std::nullopt));
  expectNear(project.frames[0].cameraFromWorld->translation, wasInBody.translation);
}

TEST(CameraMount, AnotherBodyMovesNothing) {
  Project project = onABody();
  ASSERT_TRUE(setMount(project, CameraId{1}, *mountOf({"car", {0.5, 0, -1}, {0, 0, 0.3}})));
  const RigidTransform was = *project.frames[0].cameraFromWorld;
  EXPECT_EQ(setMount(project, CameraId{1}, *mountOf({"left", {0.11, 0, 0}, {0, 0, 0}})).value(), 0);
  EXPECT_EQ(project.cameras[0].mount->body, "left");
  expectNear(project.frames[0].cameraFromWorld->translation, was.translation);
}

TEST(CameraMount, ATrajectoryOfSeveralCamerasStaysAndSoDoesTheProject) {
  Project project = onABody();
  project.frames[1].camera = {2};
  const auto set = setMount(project, CameraId{1}, *mountOf({"car", {0.5, 0, 0}, {}}));
  ASSERT_FALSE(set);
  EXPECT_NE(set.error().what.find("'way'"), std::string::npos);
  EXPECT_FALSE(project.cameras[0].mount);
  expectNear(project.frames[0].cameraFromWorld->centre(), {100.5, 200, 10});
  EXPECT_TRUE(setMount(project, CameraId{1}, *mountOf({"car", {}, {}, {0.001, 0.001, 0.001}, {}}))) << "nothing moves";
}

}  // namespace alidade
