// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/pose_matching.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

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

TEST(PoseMatching, OnlyAPicturesEndingIsTakenOffAName) {
  Project project = projectWithFrames({"scan.0001.jpg", "scan.0002.jpg"});
  CameraSource source{"cams.xml", {}};
  source.set.cameras = {pinhole(100, 80)};
  source.set.pictures = {posed("scan.0002", 2), posed("scan.0001", 1)};
  matchPoses(project, {source});
  ASSERT_TRUE(project.frames[0].cameraFromWorld && project.frames[1].cameraFromWorld);
  EXPECT_DOUBLE_EQ(project.frames[0].cameraFromWorld->centre().x, 1);
  EXPECT_DOUBLE_EQ(project.frames[1].cameraFromWorld->centre().x, 2);
}

TEST(PoseMatching, PicturesOfOneNameGoByTheirFoldersOrNotAtAll) {
  Project project = projectWithFrames({"001.png", "001.png", "001.png"});
  project.frames[0].image.path = "/data/Right/001.png";
  project.frames[1].image.path = "/data/left/001.png";
  project.frames[2].image.path = "/elsewhere/001.png";
  CameraSource source{"sparse", {}};
  source.set.cameras = {pinhole(100, 80)};
  source.set.pictures = {posed("left/001.png", 1), posed("right\\001.png", 2)};
  const auto notes = matchPoses(project, {source});
  EXPECT_DOUBLE_EQ(project.frames[0].cameraFromWorld.value().centre().x, 2);
  EXPECT_DOUBLE_EQ(project.frames[1].cameraFromWorld.value().centre().x, 1);
  EXPECT_FALSE(project.frames[2].cameraFromWorld);
  EXPECT_TRUE(anyMentions(notes, "1 picture is named like several in sparse"));
}

TEST(PoseMatching, ACameraWithoutSizeTakesThatOfEachPicture) {
  std::string pattern = "/tmp/alidade-matching-XXXXXX";
  const std::string folder = mkdtemp(pattern.data());
  const auto bmp = [&](const std::string& name, char width, char height) {
    std::string bytes("BM\0\0\0\0\0\0\0\0\x3e\0\0\0\x28\0\0\0\0\0\0\0\0\0\0\0\1\0\1\0", 30);
    bytes[18] = width;
    bytes[22] = height;
    bytes.resize(4000, '\0');
    std::ofstream(folder + "/" + name, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    return folder + "/" + name;
  };
  Project project = projectWithFrames({"a.bmp", "b.bmp", "gone.bmp"});
  project.frames[0].image.path = bmp("a.bmp", 100, 80);
  project.frames[1].image.path = bmp("b.bmp", 80, 100);
  project.frames[2].image.path = folder + "/gone.bmp";
  CameraSource source{"bundle.out", {}};
  source.set.cameras = {pinhole(20, 20)};
  source.set.camerasWithoutSize = {0};
  source.set.pictures = {posed("a.bmp", 1), posed("b.bmp", 2), posed("gone.bmp", 3)};
  const auto notes = matchPoses(project, {source});
  std::filesystem::remove_all(folder);
  ASSERT_EQ(project.cameras.size(), 2u);
  const Intrinsics& wide = project.findCamera(project.frames[0].camera)->camera.intrinsics();
  EXPECT_EQ(wide.width, 100);
  EXPECT_EQ(wide.cx, 49.5);
  EXPECT_EQ(project.findCamera(project.frames[1].camera)->camera.intrinsics().cy, 49.5);
  EXPECT_FALSE(project.frames[2].camera);
  EXPECT_TRUE(anyMentions(notes, "bundle.out states no picture size"));
}

TEST(PoseMatching, AModelsCameraNeverServesAPictureThatTheModelGaveNone) {
  Project project = projectWithFrames({"a", "b"});
  CameraSource source{"xmp", {}};
  source.set.cameras = {pinhole(100, 80), pinhole(200, 80)};
  source.set.pictures = {posed("a", 1, 1), posed("b", 2, -1)};
  const auto notes = matchPoses(project, {source});
  EXPECT_TRUE(project.frames[1].cameraFromWorld);
  EXPECT_FALSE(project.frames[1].camera);
  EXPECT_TRUE(anyMentions(notes, "no camera"));
  CameraSource calibration{"calib.yml", {}};
  calibration.set.cameras = {pinhole(640, 480)};
  Project other = projectWithFrames({"a", "b"});
  matchPoses(other, {source, calibration});
  EXPECT_EQ(other.findCamera(other.frames[0].camera)->camera.width(), 200);
  EXPECT_EQ(other.findCamera(other.frames[1].camera)->camera.width(), 640);
}

TEST(PoseMatching, ARigsTrajectoryServesEachCameraFromItsOwnPlace) {
  Project project = projectWithFrames({"l0", "l1", "r0", "r1"});
  for (std::size_t i = 0; i < 4; ++i) project.frames[i].timeSecs = 0.5 * double(i % 2);
  // The sensor moves east at 10 m/s and has turned a quarter to the left; its clock is a second ahead.
  CameraSet trajectory;
  const glm::dquat left = glm::angleAxis(std::numbers::pi / 2, glm::dvec3(0, 0, 1));
  for (double t = 0.9; t < 2; t += 0.1) {
    PosedPicture pose;
    pose.hasTime = true;
    pose.timeSecs = t;
    pose.cameraFromWorld = RigidTransform{left, {10 * (t - 1), 0, 0}}.inverse();
    trajectory.pictures.push_back(pose);
  }
  std::vector<CameraSource> sources;
  for (const int side : {-1, 1}) {  // 0.2 m to either side along the sensor's x
    CameraSource source{"rig.json", rigCameraSet(trajectory, {{1, 0, 0, 0}, {0.2 * side, 0, 0.1}}, pinhole(side < 0 ? 100 : 200, 80), 1.0)};
    source.name = side < 0 ? "left" : "right";
    source.mount = CameraMount{"sensor", RigidTransform{{1, 0, 0, 0}, {-0.2 * side, 0, -0.1}}};
    for (std::int64_t i = side < 0 ? 1 : 3; i <= (side < 0 ? 2 : 4); ++i) source.only.push_back(FrameId{i});
    sources.push_back(source);
  }
  const auto notes = matchPoses(project, sources);
  EXPECT_TRUE(notes.empty());
  for (std::size_t i = 0; i < 4; ++i) {
    const Frame& frame = project.frames[i];
    ASSERT_TRUE(frame.cameraFromWorld) << i;
    // The sensor's x points north now.
    const glm::dvec3 expected(10 * frame.timeSecs, i < 2 ? -0.2 : 0.2, 0.1);
    EXPECT_LT(glm::length(frame.cameraFromWorld->centre() - expected), 1e-9) << i;
    const CameraRecord& camera = *project.findCamera(frame.camera);
    EXPECT_EQ(camera.camera.width(), i < 2 ? 100 : 200);
    EXPECT_EQ(camera.name, i < 2 ? "left" : "right");
    ASSERT_TRUE(camera.mount);
    EXPECT_EQ(camera.mount->body, "sensor");
    EXPECT_EQ(camera.mount->cameraFromBody.centre().x, i < 2 ? -0.2 : 0.2);
  }
}

TEST(PoseMatching, PosesWithoutNamesLeaveOutTheFramesThatAnotherSourceBrought) {
  Project project = projectWithFrames({"Image 1", "a.jpg", "b.jpg"});
  CameraSource scan{"scan.e57", {}, {FrameId{1}}};
  scan.set.cameras = {pinhole(100, 80)};
  scan.set.pictures = {posed("Image 1", 500)};
  CameraSource way{"way.txt", {}, {}};
  way.set.pictures = {posed("", 1, -1), posed("", 2, -1)};
  matchPoses(project, {scan, way});
  ASSERT_TRUE(project.frames[0].cameraFromWorld && project.frames[1].cameraFromWorld && project.frames[2].cameraFromWorld);
  EXPECT_NEAR(project.frames[0].cameraFromWorld->centre().x, 500, 1e-9);
  EXPECT_NEAR(project.frames[1].cameraFromWorld->centre().x, 1, 1e-9);
  EXPECT_NEAR(project.frames[2].cameraFromWorld->centre().x, 2, 1e-9);
}

}  // namespace alidade
