// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What is exported comes back through the readers: poses within 1e-12, pixels within 1e-9.

#include "io/camera_export.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/colmap_reader.h"
#include "geometry/attitude.h"
#include "trajectory/pose_table_reader.h"
#include "transforms/transforms_reader.h"

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

struct Folder {
  fs::path path;
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "alidade-export-XXXXXX").string();
    path = mkdtemp(pattern.data());
  }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
};

Intrinsics made(CameraModel model, const std::vector<double>& parameters) {
  return Intrinsics::fromParameters(model, 1920, 1080, parameters).value();
}

/// One camera a lens, one frame a camera; attitudes in all directions, two of them where omega and kappa merge.
Project projectWith(const std::vector<Intrinsics>& lenses, const glm::dvec3& origin = {12.5, -7.25, 3.125}) {
  Project project;
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    CameraRecord camera;
    camera.id.value = std::int64_t(i) + 1;
    camera.name = "camera " + std::to_string(i + 1);
    camera.camera = Camera(lenses[i]);
    project.cameras.push_back(camera);
    Frame frame;
    frame.id.value = std::int64_t(i) + 1;
    frame.name = "picture " + std::to_string(i + 1) + ".jpg";
    frame.image.path = "/data/photos/" + frame.name;
    frame.camera = camera.id;
    frame.timeSecs = 0.1 * double(i) + 1.0 / 3;
    const double quarter = std::numbers::pi / 2;
    const glm::dquat attitude = worldFromCameraRotation({0.7 * double(i) - 1, i == 1 ? quarter : i == 2 ? -quarter : 0.3 * double(i), 0.9});
    frame.cameraFromWorld = RigidTransform{attitude, origin + glm::dvec3(double(i), 1.0 / (double(i) + 3), 0.7)}.inverse();
    project.frames.push_back(frame);
  }
  return project;
}

std::vector<Intrinsics> lensesOfTransforms() {
  using enum CameraModel;
  return {made(Pinhole, {1400, 1390, 955.3, 545.7}), made(OpenCv4, {1400, 1390, 955, 545, -0.28, 0.09, 1e-3, -7e-4}),
          made(OpenCv5, {1400, 1390, 955, 545, -0.28, 0.09, 1e-3, -7e-4, 0.01}), made(OpenCvFisheye, {480, 482, 955, 545, -0.013, 0.006, -0.004, 0.0007}),
          made(SimpleRadial, {1400, 955, 545, -0.1})};
}

std::vector<Intrinsics> lensesOfColmap() {
  using enum CameraModel;
  auto lenses = lensesOfTransforms();
  lenses.push_back(made(SimplePinhole, {1400, 955, 545}));
  lenses.push_back(made(Radial, {1400, 955, 545, -0.1, 0.02}));
  lenses.push_back(made(OpenCv8, {1400, 1390, 955, 545, 0.4, -0.3, 4e-4, -3e-4, 0.06, 0.7, -0.28, 0.013}));
  lenses.push_back(made(OpenCv14, {1400, 1390, 955, 545, -0.2, 0.05, 8e-4, -5e-4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));  // of zeros
  return lenses;
}

void expectSame(const Project& project, const CameraSet& set, bool withLenses, double metres = 1e-12) {
  ASSERT_EQ(set.pictures.size(), project.frames.size());
  for (std::size_t i = 0; i < project.frames.size(); ++i) {
    const Frame& frame = project.frames[i];
    const PosedPicture& picture = set.pictures[i];
    EXPECT_EQ(fs::path(picture.name).filename().string(), frame.name);
    ASSERT_TRUE(picture.cameraFromWorld);
    EXPECT_LT(rotationAngleBetween(*picture.cameraFromWorld, *frame.cameraFromWorld), 1e-12) << frame.name;
    EXPECT_LT(glm::length(picture.cameraFromWorld->centre() - frame.cameraFromWorld->centre()), metres) << frame.name;
    if (!withLenses) continue;
    const Camera& before = project.cameras[i].camera;
    const Camera after(set.cameras.at(std::size_t(picture.camera)));
    EXPECT_EQ(after.width(), before.width());
    for (double x = -0.6; x <= 0.6; x += 0.2)
      for (double y = -0.3; y <= 0.3; y += 0.1)
        EXPECT_LT(glm::length(before.projectUnchecked({x, y, 1}) - after.projectUnchecked({x, y, 1})), 1e-9) << frame.name;
  }
}

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

TEST(CameraExport, ColmapsTextModelComesBack) {
  const Folder folder;
  Project project = projectWith(lensesOfColmap());
  Observation seen;
  seen.world = {1.1, 2.2, 3.3};
  for (const std::int64_t frame : {1, 2}) {
    seen.frame.value = frame;
    seen.pixel = {100.25 * double(frame), 50.5};
    project.observations.push_back(seen);
  }
  seen.enabled = false;
  project.observations.push_back(seen);
  const auto done = exportCameras(project, cameraFormatOf(folder / "sparse"), folder / "sparse");
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_EQ(done->points, 1u);
  const auto set = ColmapReader().read(folder / "sparse", Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_TRUE(set->warnings.empty());
  expectSame(project, *set, true);
  ASSERT_EQ(set->tiePoints.size(), 1u);
  EXPECT_EQ(set->tiePoints[0].world, glm::dvec3(1.1, 2.2, 3.3));
  ASSERT_EQ(set->tiePoints[0].seenIn.size(), 2u);
  EXPECT_EQ(set->tiePoints[0].seenIn[1].second, glm::dvec2(200.5, 50.5));
  EXPECT_THAT(contents(folder / "sparse/cameras.txt"), HasSubstr("1 PINHOLE 1920 1080 1400 1390 955.8 546.2"));
  EXPECT_THAT(contents(folder / "sparse/cameras.txt"), HasSubstr("9 OPENCV 1920")) << "no more than it needs";
  EXPECT_THAT(contents(folder / "sparse/images.txt"), HasSubstr("\n100.75 51 1 \n"));
}

TEST(CameraExport, TransformsJsonComesBackWithSharedAndWithOwnIntrinsics) {
  const Folder folder;
  const Project many = projectWith(lensesOfTransforms());
  ASSERT_TRUE(exportCameras(many, cameraFormatOf("T.JSON"), folder / "transforms.json"));
  const auto set = TransformsReader().read(folder / "transforms.json", Progress());
  ASSERT_TRUE(set) << set.error().text();
  expectSame(many, *set, true);
  Project one = projectWith({lensesOfTransforms()[1], lensesOfTransforms()[1]});
  one.frames[1].camera = one.frames[0].camera;
  ASSERT_TRUE(exportCameras(one, CameraFormat::Transforms, folder / "one.json"));
  const auto shared = TransformsReader().read(folder / "one.json", Progress());
  ASSERT_TRUE(shared) << shared.error().text();
  EXPECT_EQ(shared->cameras.size(), 1u);
  expectSame(one, *shared, true);
  const std::string text = contents(folder / "one.json");
  EXPECT_LT(text.find("fl_x"), text.find("frames"));
  EXPECT_EQ(text.find("fl_x"), text.rfind("fl_x")) << "once, for all";
}

TEST(CameraExport, TheTableComesBackAlsoAtPhisRightAngles) {
  const Folder folder;
  const Project project = projectWith(lensesOfTransforms());
  const auto done = exportCameras(project, cameraFormatOf("a.csv"), folder / "a.csv");
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_THAT(done->notes.at(0), HasSubstr("no lenses"));
  const auto set = PoseTableReader().read(folder / "a.csv", Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_TRUE(set->warnings.empty());
  expectSame(project, *set, false);
  EXPECT_EQ(set->pictures[2].timeSecs, project.frames[2].timeSecs);
}

TEST(CameraExport, FarFromTheOriginOnlyTheDoublesOwnStepIsLost) {
  const Folder folder;
  const Project project = projectWith(lensesOfTransforms(), {2683512.4, 1247811.9, 413.2});
  ASSERT_TRUE(exportCameras(project, CameraFormat::Colmap, folder / "sparse"));
  ASSERT_TRUE(exportCameras(project, CameraFormat::Transforms, folder / "t.json"));
  ASSERT_TRUE(exportCameras(project, CameraFormat::Table, folder / "t.csv"));
  const auto colmap = ColmapReader().read(folder / "sparse", Progress());
  ASSERT_TRUE(colmap);
  for (std::size_t i = 0; i < project.frames.size(); ++i)
    EXPECT_EQ(colmap->pictures[i].cameraFromWorld->translation, project.frames[i].cameraFromWorld->translation) << "bit for bit";
  expectSame(project, *colmap, true, 5e-9);
  expectSame(project, TransformsReader().read(folder / "t.json", Progress()).value(), true, 5e-9);
  expectSame(project, PoseTableReader().read(folder / "t.csv", Progress()).value(), false, 5e-9);
}

TEST(CameraExport, ALensThatTheFormatCannotSayIsRefusedByItsCoefficient) {
  const Folder folder;
  using enum CameraModel;
  const auto refused = [&](const Intrinsics& lens, CameraFormat format, const char* coefficient) {
    const auto done = exportCameras(projectWith({lens}), format, folder / "out");
    ASSERT_FALSE(done) << coefficient;
    EXPECT_THAT(done.error().what, HasSubstr(std::string("coefficient ") + coefficient));
    EXPECT_EQ(done.error().where, "camera 1");
    EXPECT_FALSE(fs::exists(folder / "out"));
  };
  const Intrinsics rational = made(OpenCv8, {1400, 1390, 955, 545, 0.4, -0.3, 4e-4, -3e-4, 0.06, 0.7, -0.28, 0.013});
  const Intrinsics tilted = made(OpenCv14, {1400, 1390, 955, 545, -0.2, 0.05, 8e-4, -5e-4, 0, 0, 0, 0, 0, 0, 0, 0, 0.01, 0});
  const Intrinsics skewed = made(BrownSkewed, {1400, 1390, 955, 545, -0.2, 0.05, 0, 0, 0, 0, 0, 0, 0.001});
  refused(rational, CameraFormat::Transforms, "q1");
  refused(tilted, CameraFormat::Colmap, "tauX");
  refused(skewed, CameraFormat::Colmap, "imageSkew");
  refused(skewed, CameraFormat::Transforms, "imageSkew");
  EXPECT_TRUE(exportCameras(projectWith({skewed}), CameraFormat::Table, folder / "out.csv")) << "a table has no lens";
}

TEST(CameraExport, WhatIsLeftOutIsNotedAndNothingAtAllIsAnError) {
  const Folder folder;
  Project project = projectWith({lensesOfTransforms()[0], lensesOfTransforms()[0], lensesOfTransforms()[0]});
  project.frames[0].cameraFromWorld.reset();
  project.frames[1].camera = {};
  const auto done = exportCameras(project, CameraFormat::Colmap, folder / "s");
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_EQ(done->frames, 1u);
  ASSERT_EQ(done->notes.size(), 2u);
  EXPECT_EQ(exportCameras(project, CameraFormat::Table, folder / "s.csv")->frames, 2u);
  project.frames[2].cameraFromWorld.reset();
  const auto none = exportCameras(project, CameraFormat::Colmap, folder / "t");
  ASSERT_FALSE(none);
  EXPECT_FALSE(fs::exists(folder / "t"));
}

TEST(CameraExport, PicturesOfOneNameKeepTheirFolders) {
  const Folder folder;
  Project project = projectWith({lensesOfTransforms()[0], lensesOfTransforms()[0]});
  project.frames[0].image.path = "/data/left/1.jpg";
  project.frames[1].image.path = "/data/right/1.jpg";
  ASSERT_TRUE(exportCameras(project, CameraFormat::Colmap, folder / "s"));
  EXPECT_EQ(ColmapReader().inspect(folder / "s")->pictures[1].name, "right/1.jpg");
  project.frames[1].image.path = "/other/left/1.jpg";
  EXPECT_FALSE(exportCameras(project, CameraFormat::Colmap, folder / "t"));
}

TEST(CameraExport, ATargetThatCannotBeWrittenIsAnError) {
  const Project project = projectWith({lensesOfTransforms()[0]});
  EXPECT_FALSE(exportCameras(project, CameraFormat::Colmap, "/proc/nowhere/s"));
  EXPECT_FALSE(exportCameras(project, CameraFormat::Transforms, "/proc/nowhere/t.json"));
}

}  // namespace alidade
