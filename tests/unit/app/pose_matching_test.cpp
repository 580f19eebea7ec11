// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/pose_matching.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace alidade {

namespace {

Intrinsics pinhole(int width, int height) {
  Intrinsics in;
  in.width = width;
  in.height = height;
  in.fx = in.fy = 100;
  in.cx = width / 2.0;
  in.cy = height / 2.0;
  return in;
}

Project projectWithFrames(const std::vector<std::string>& names, double step = 0) {
  Project project;
  for (std::size_t i = 0; i < names.size(); ++i) {
    Frame frame;
    frame.id.value = static_cast<std::int64_t>(i) + 1;
    frame.name = names[i];
    frame.timeSecs = step * static_cast<double>(i);
    project.frames.push_back(frame);
  }
  return project;
}

PosedPicture posed(const std::string& name, double eastOfCentre, int camera = 0) {
  PosedPicture picture;
  picture.name = name;
  picture.camera = camera;
  picture.cameraFromWorld = RigidTransform{{1, 0, 0, 0}, {-eastOfCentre, 0, 0}};
  return picture;
}

PosedPicture posedAt(double time, double eastOfCentre) {
  PosedPicture picture = posed("", eastOfCentre, -1);
  picture.hasTime = true;
  picture.timeSecs = time;
  return picture;
}

bool anyMentions(const std::vector<std::string>& notes, const std::string& text) {
  return std::any_of(notes.begin(), notes.end(), [&](const auto& n) { return n.find(text) != std::string::npos; });
}

}  // namespace

TEST(PoseMatching, NamesMatchWhateverTheirEndingCaseOrFolder) {
  Project project = projectWithFrames({"IMG_1.JPG", "IMG_2.JPG"});
  CameraSource source{"sparse", {}};
  source.set.cameras = {pinhole(100, 80)};
  source.set.pictures = {posed("cam0/img_2.png", 2), posed("img_1.png", 1), posed("img_9.png", 9)};
  const auto notes = matchPoses(project, {source});
  ASSERT_TRUE(project.frames[0].cameraFromWorld && project.frames[1].cameraFromWorld);
  EXPECT_DOUBLE_EQ(project.frames[0].cameraFromWorld->centre().x, 1);
  EXPECT_DOUBLE_EQ(project.frames[1].cameraFromWorld->centre().x, 2);
  EXPECT_TRUE(project.frames[0].camera);
  EXPECT_TRUE(anyMentions(notes, "1 pose of sparse has no picture"));
}

TEST(PoseMatching, ATrajectoryIsInterpolatedButNeverBeyondItsEndsOrAcrossAGap) {
  Project project = projectWithFrames({"a", "b", "c", "d"}, 0.5);  // 0, 0.5, 1.0, 1.5 s
  CameraSource source{"trajectory.txt", {}};
  for (const double t : {0.25, 0.35, 0.45, 0.55, 0.65, 1.25}) source.set.pictures.push_back(posedAt(t, 10 * t));
  matchPoses(project, {source});
  EXPECT_FALSE(project.frames[0].cameraFromWorld) << "before the first pose";
  ASSERT_TRUE(project.frames[1].cameraFromWorld);
  EXPECT_NEAR(project.frames[1].cameraFromWorld->centre().x, 5.0, 1e-12);
  EXPECT_EQ(project.frames[1].poseSource, PoseSource::Interpolated);
  EXPECT_FALSE(project.frames[2].cameraFromWorld) << "in a gap of six steps";
  EXPECT_FALSE(project.frames[3].cameraFromWorld) << "after the last pose";
}

TEST(PoseMatching, ATrajectoryWithAPoseForEveryPictureGoesByOrderAndGivesTimes) {
  Project project = projectWithFrames({"a", "b"});
  CameraSource source{"trajectory.txt", {}};
  source.set.pictures = {posedAt(3.0, 1), posedAt(3.1, 2)};
  matchPoses(project, {source});
  ASSERT_TRUE(project.frames[1].cameraFromWorld);
  EXPECT_DOUBLE_EQ(project.frames[1].timeSecs, 3.1);
}

TEST(PoseMatching, ACalibrationServesTheFramesThatAPoseFileLeftWithoutOne) {
  Project project = projectWithFrames({"a", "b"});
  CameraSource calibration{"calib.yml", {}};
  calibration.set.cameras = {pinhole(640, 480)};
  CameraSource trajectory{"trajectory.txt", {}};
  trajectory.set.pictures = {posedAt(0, 1), posedAt(0.1, 2)};
  const auto notes = matchPoses(project, {calibration, trajectory});
  ASSERT_EQ(project.cameras.size(), 1u);
  EXPECT_EQ(project.frames[0].camera, project.cameras[0].id);
  EXPECT_TRUE(notes.empty());
}

TEST(PoseMatching, PicturesWithoutAPoseAreNamedWithTheNextStep) {
  Project project = projectWithFrames({"a", "b", "c"});
  CameraSource source{"sparse", {}};
  source.set.cameras = {pinhole(640, 480)};
  source.set.pictures = {posed("a", 1)};
  const auto notes = matchPoses(project, {source});
  EXPECT_TRUE(anyMentions(notes, "2 pictures have no pose"));
}

}  // namespace alidade
