// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/colmap_reader.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "colmap/colmap_model.h"

namespace alidade {

namespace fs = std::filesystem;
using testing::HasSubstr;

namespace {

const std::string kCamera = "1 PINHOLE 640 480 500 510 320 240\n";

Result<CameraSet> parsed(const std::string& cameras, const std::string& images, const std::string& points = "") {
  ColmapModel model;
  if (auto done = parseColmapCameras(cameras, "cameras.txt", model); !done) return fail(done.error());
  if (auto done = parseColmapImages(images, "images.txt", true, Progress(), model); !done) return fail(done.error());
  if (auto done = parseColmapPoints(points, "points3D.txt", Progress(), model); !done) return fail(done.error());
  return model.take();
}

std::string sharedModel(const std::string& folder) { return std::string(ALIDADE_SHARED_DATA_DIR) + "/" + folder; }

}  // namespace

TEST(Colmap, MovesThePixelOriginByHalfAPixel) {
  const auto set = parsed(kCamera, "1 1 0 0 0 0 0 0 1 a.jpg\n100.5 50.5 7\n", "7 0 0 5 1 2 3 0.1 1 0\n");
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->cameras[0].cx, 319.5);
  EXPECT_EQ(set->cameras[0].cy, 239.5);
  ASSERT_EQ(set->tiePoints.size(), 1u);
  EXPECT_EQ(set->tiePoints[0].seenIn[0].second, glm::dvec2(100, 50));
  EXPECT_EQ(set->tiePoints[0].colour, (Rgba8{1, 2, 3, 255}));
}

TEST(Colmap, ReadsEveryModelThatACameraKnows) {
  const std::pair<const char*, CameraModel> cases[] = {
      {"1 SIMPLE_PINHOLE 640 480 500 320 240", CameraModel::SimplePinhole},
      {"1 PINHOLE 640 480 500 510 320 240", CameraModel::Pinhole},
      {"1 SIMPLE_RADIAL 640 480 500 320 240 0.01", CameraModel::SimpleRadial},
      {"1 RADIAL 640 480 500 320 240 0.01 0.02", CameraModel::Radial},
      {"1 OPENCV 640 480 500 510 320 240 .1 .2 .001 .002", CameraModel::OpenCv4},
      {"1 FULL_OPENCV 640 480 500 510 320 240 .1 .2 .001 .002 .3 .4 .5 .6", CameraModel::OpenCv8},
      {"1 OPENCV_FISHEYE 640 480 500 510 320 240 .1 .02 .003 .004", CameraModel::OpenCvFisheye},
  };
  for (const auto& [line, model] : cases) {
    const auto set = parsed(line, "");
    ASSERT_TRUE(set) << line << ": " << set.error().text();
    EXPECT_EQ(set->cameras[0].model, model);
    EXPECT_EQ(set->cameras[0].cx, 319.5);
  }
}

TEST(Colmap, ShortFisheyeModelsAreOpenCvsWithZeros) {
  const auto set = parsed("1 RADIAL_FISHEYE 640 480 500 320 240 0.1 0.02", "");
  ASSERT_TRUE(set) << set.error().text();
  const auto& k = set->cameras[0];
  EXPECT_EQ(k.model, CameraModel::OpenCvFisheye);
  EXPECT_EQ(k.fx, 500);
  EXPECT_EQ(k.fy, 500);
  EXPECT_EQ(k.distortion.k[1], 0.02);
  EXPECT_EQ(k.distortion.k[2], 0);
}

TEST(Colmap, RefusesAnUnknownModelByName) {
  const auto set = parsed(kCamera + "2 FOV 640 480 500 500 320 240 0.9\n", "");
  ASSERT_FALSE(set);
  EXPECT_THAT(set.error().what, HasSubstr("'FOV'"));
  EXPECT_EQ(set.error().where, "cameras.txt, line 2");
  EXPECT_THAT(set.error().advice, HasSubstr("image_undistorter"));
}

TEST(Colmap, KeepsBlanksInNamesAndEmptyPointLines) {
  const auto set = parsed(kCamera, "# remark\n1 2 0 0 0 1 2 3 1 my picture 1.jpg\n\n2 1 0 0 0 0 0 0 1 sub/b.jpg\n1 2 -1\n");
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 2u);
  EXPECT_EQ(set->pictures[0].name, "my picture 1.jpg");
  EXPECT_EQ(set->pictures[0].cameraFromWorld->rotation.w, 1.0) << "normalised";
  EXPECT_EQ(set->pictures[0].cameraFromWorld->translation, glm::dvec3(1, 2, 3));
  EXPECT_TRUE(set->warnings.empty());
}

TEST(Colmap, ToleratesWithAWarning) {
  const auto set = parsed(kCamera,
                          "1 1 0 0 0 0 0 0 9 a.jpg\n"      // no such camera, no line of points
                          "2 1 0 0 0 0 0 0 1 a.jpg\n\n",   // the name again
                          "1 0 0 1 0 0 0 0 1 5 8 0\n");    // no such feature, no such image
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures[0].camera, -1);
  EXPECT_EQ(set->pictures[1].camera, 0);
  EXPECT_TRUE(set->tiePoints[0].seenIn.empty());
  ASSERT_EQ(set->warnings.size(), 4u);
  EXPECT_THAT(set->warnings[3].what, HasSubstr("2 sightings"));
}

TEST(Colmap, RefusesBrokenLinesByNumber) {
  struct Case {
    std::string cameras, images, points, where;
  };
  const Case cases[] = {
      {"1 PINHOLE 640 480 500 510 320\n", "", "", "cameras.txt, line 1"},
      {"1 PINHOLE 640 480 500 nan 320 240\n", "", "", "cameras.txt, line 1"},
      {"1 PINHOLE 0 480 500 510 320 240\n", "", "", "cameras.txt, line 1"},
      {"1 PINHOLE 99999999999 480 500 510 320 240\n", "", "", "cameras.txt, line 1"},
      {kCamera + kCamera, "", "", "cameras.txt, line 2"},
      {"hello\n", "", "", "cameras.txt, line 1"},
      {kCamera, "1 nan 0 0 0 0 0 0 1 a.jpg\n\n", "", "images.txt, line 1"},
      {kCamera, "1 1 0 0 0 0 inf 0 1 a.jpg\n\n", "", "images.txt, line 1"},
      {kCamera, "1 0 0 0 0 0 0 0 1 a.jpg\n\n", "", "images.txt, line 1"},
      {kCamera, "1 1 0 0 0 0 0 0 1\n\n", "", "images.txt, line 1"},
      {kCamera, "1 1 0 0 0 0 0 0 1 a.jpg\n\n1 1 0 0 0 0 0 0 1 b.jpg\n\n", "", "images.txt, line 3"},
      {kCamera, "1 1 0 0 0 0 0 0 1 a.jpg\n1 2\n", "", "images.txt, line 2"},
      {kCamera, "1 1 0 0 0 0 0 0 1 a.jpg\n1 inf 3\n", "", "images.txt, line 2"},
      {kCamera, "", "1 0 0\n", "points3D.txt, line 1"},
      {kCamera, "", "1 0 0 1e999 1 2 3 0\n", "points3D.txt, line 1"},
      {kCamera, "", "1 0 0 1 1 2 300 0\n", "points3D.txt, line 1"},
      {kCamera, "", "1 0 0 1 1 2 3 0 4\n", "points3D.txt, line 1"},
  };
  for (const Case& c : cases) {
    const auto set = parsed(c.cameras, c.images, c.points);
    ASSERT_FALSE(set) << c.cameras << c.images << c.points;
    EXPECT_THAT(set.error().where, HasSubstr(c.where)) << set.error().text();
    EXPECT_FALSE(set.error().advice.empty());
  }
}

TEST(Colmap, SurvivesRandomDamage) {
  const std::string whole[] = {kCamera + "2 OPENCV 64 48 50 51 32 24 .1 .2 .001 .002\n",
                               "1 1 0 0 0 0 0 0 1 a.jpg\n100.5 50.5 7 3 4 -1\n2 1 0 0 0 1 2 3 2 b.jpg\n\n",
                               "7 0 0 5 1 2 3 0.1 1 0 1 1\n8 1 2 3 4 5 6 0.2 2 0\n"};
  std::mt19937 random(11);
  const std::string alphabet = "0123456789 .-+einfa#\n\r\t\xff";
  for (int i = 0; i < 5000; ++i) {
    std::string text[3] = {whole[0], whole[1], whole[2]};
    for (int k = 0; k < 3; ++k) {
      std::string& part = text[random() % 3];
      if (part.empty()) continue;
      if (random() % 4 == 0) part.resize(random() % part.size());
      else part[random() % part.size()] = alphabet[random() % alphabet.size()];
    }
    (void)parsed(text[0], text[1], text[2]);
  }
}

TEST(Colmap, CanBeCancelled) {
  const Progress progress;
  progress.cancel();
  ColmapModel model;
  const auto done = parseColmapImages("1 1 0 0 0 0 0 0 1 a.jpg\n\n", "images.txt", true, progress, model);
  ASSERT_FALSE(done);
  EXPECT_TRUE(isCancelled(done.error()));
}

// The published median residual of this ground truth is 0.23-0.25 px: it only comes out where poses,
// lens, pixel origin and tracks are all read rightly.
TEST(Colmap, TheDoorsPointsLandOnTheirObservations) {
  const std::string folder = sharedModel("lund_door/colmap_ground_truth");
  if (!fs::exists(folder)) GTEST_SKIP() << "needs " << folder;
  const auto set = ColmapReader().read(folder, Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->pictures.size(), 12u);
  EXPECT_EQ(set->tiePoints.size(), 11384u);
  EXPECT_TRUE(set->warnings.empty());
  const Camera camera(set->cameras.at(0));
  std::vector<double> residuals;
  for (const TiePoint& point : set->tiePoints)
    for (const auto& [picture, pixel] : point.seenIn) {
      const auto projected = camera.project(*set->pictures[std::size_t(picture)].cameraFromWorld * point.world);
      ASSERT_TRUE(projected);
      residuals.push_back(glm::length(*projected - pixel));
    }
  EXPECT_GT(residuals.size(), 70000u);
  std::nth_element(residuals.begin(), residuals.begin() + std::ptrdiff_t(residuals.size() / 2), residuals.end());
  const double median = residuals[residuals.size() / 2];
  RecordProperty("median_px", std::to_string(median));
  EXPECT_GT(median, 0.22);
  EXPECT_LT(median, 0.255);
}

TEST(Colmap, TheRoadsCameraIsTheCalibrations) {
  const std::string folder = sharedModel("road/sparse");
  if (!fs::exists(folder)) GTEST_SKIP() << "needs " << folder;
  const auto set = ColmapReader().inspect(folder + "/images.txt");
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 78u);
  EXPECT_EQ(set->pictures[6].name, "101_0367_0007.JPG");
  EXPECT_DOUBLE_EQ(set->cameras[0].cx, 2731.4405032761174);  // as opencv_calib.yml
  EXPECT_NEAR(glm::length(glm::dvec2(set->pictures[6].cameraFromWorld->centre()) - glm::dvec2(100600, 196250)), 0, 200);
}

}  // namespace alidade
