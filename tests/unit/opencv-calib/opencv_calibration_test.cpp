// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "opencv-calib/opencv_calibration_reader.h"

#include <filesystem>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

namespace alidade {

using testing::HasSubstr;

namespace {

/// What OpenCV itself writes; `ending` is ".yml", ".xml" or ".json".
std::string written(const cv::Mat& matrix, const cv::Mat& lens, const std::string& ending = ".yml", bool fisheye = false) {
  cv::FileStorage storage("calibration" + ending, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "image_width" << 640 << "image_height" << 480;
  if (fisheye) storage << "fisheye_model" << 1;
  storage << "camera_matrix" << matrix << "distortion_coefficients" << lens;
  return storage.releaseAndGetString();
}

cv::Mat cameraMatrix() { return (cv::Mat_<double>(3, 3) << 500.25, 0, 320.125, 0, 510.5, 240.75, 0, 0, 1); }

cv::Mat lensOf(int coefficients) {
  const double all[] = {-0.2, 0.05, 0.001, -0.002, 0.01, 0.1, -0.05, 0.01, 1e-4, 2e-4, 3e-4, 4e-4, 0.01, -0.02};
  return cv::Mat(1, coefficients, CV_64F, const_cast<double*>(all)).clone();
}

const std::string kYaml = "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
                          "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 510., 240., 0., 0., 1. ]\n"
                          "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
                          "   data: [ -0.2, 0.05, 0., 0., 0. ]\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST(OpenCvCalibration, EveryLensProjectsAsOpenCvDoes) {
  for (const int coefficients : {4, 5, 8, 12, 14}) {
    const cv::Mat lens = lensOf(coefficients);
    const auto set = parseOpenCvCalibration(written(cameraMatrix(), lens), "c.yml");
    ASSERT_TRUE(set) << set.error().text();
    const Camera camera(set->cameras.at(0));
    for (const cv::Point3d p : {cv::Point3d(0.1, 0.2, 1), cv::Point3d(-0.3, 0.15, 1.2), cv::Point3d(0.25, -0.2, 0.9)}) {
      std::vector<cv::Point2d> expected;
      cv::projectPoints(std::vector<cv::Point3d>{p}, cv::Vec3d(), cv::Vec3d(), cameraMatrix(), lens, expected);
      const auto pixel = camera.project({p.x, p.y, p.z});
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x, expected[0].x, 1e-9) << coefficients;
      EXPECT_NEAR(pixel->y, expected[0].y, 1e-9) << coefficients;
    }
  }
}

TEST(OpenCvCalibration, AFisheyeProjectsAsOpenCvDoes) {
  const cv::Mat lens = (cv::Mat_<double>(4, 1) << 0.05, -0.01, 0.002, -0.0005);
  const auto set = parseOpenCvCalibration(written(cameraMatrix(), lens, ".yml", true), "c.yml");
  ASSERT_TRUE(set) << set.error().text();
  std::vector<cv::Point2d> expected;
  cv::fisheye::projectPoints(std::vector<cv::Point3d>{{0.7, -0.4, 1}}, expected, cv::Vec3d(), cv::Vec3d(), cameraMatrix(), lens);
  const auto pixel = Camera(set->cameras[0]).project({0.7, -0.4, 1});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x, expected[0].x, 1e-9);
  EXPECT_NEAR(pixel->y, expected[0].y, 1e-9);
}

TEST(OpenCvCalibration, YamlXmlAndJsonSayTheSame) {
  for (const std::string ending : {".yml", ".xml", ".json"}) {
    const auto set = parseOpenCvCalibration(written(cameraMatrix(), lensOf(5), ending), "c" + ending);
    ASSERT_TRUE(set) << ending << set.error().text();
    EXPECT_EQ(set->cameras[0].cx, 320.125);
    EXPECT_EQ(set->cameras[0].width, 640);
    EXPECT_EQ(set->cameras[0].distortion.k[2], 0.01);
  }
}

TEST(OpenCvCalibration, ReadsRosCameraInfo) {
  const std::string ros = "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
                          "  data: [500.0, 0, 320.0, 0, 510.0, 240.0, 0, 0, 1]\ndistortion_model: plumb_bob\n"
                          "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.2, 0.05, 0, 0, 0]\n";
  const auto set = parseOpenCvCalibration(ros, "left.yaml");
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->cameras[0].model, CameraModel::OpenCv5);
  const auto thin = parseOpenCvCalibration(replaced(ros, "plumb_bob", "double_sphere"), "left.yaml");
  ASSERT_FALSE(thin);
  EXPECT_THAT(thin.error().what, HasSubstr("double_sphere"));
}

TEST(OpenCvCalibration, NamesTheKeyThatIsWrong) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"image_width: 640\n", "", "'image_width' is missing"},
      {"image_height: 480\n", "", "'image_height' is missing"},
      {"image_width: 640", "image_width: wide", "'image_width' is no number"},
      {"image_width: 640", "image_width: 0", "impossible"},
      {"image_width: 640", "image_width: 1e18", "impossible"},
      {"camera_matrix:", "other_matrix:", "'camera_matrix' is missing"},
      {"rows: 3", "rows: 4", "'camera_matrix' says 4 × 3"},
      {"rows: 3", "rows: 2000000000", "'camera_matrix' says 2000000000"},
      {"rows: 3", "rows: 1", "'camera_matrix' says 1 × 3"},
      {"500., 0., 320.", "500., x, 320.", "'camera_matrix' holds something"},
      {"500., 0., 320.", ".Nan, 0., 320.", "'camera_matrix' holds a number that is not finite"},
      {"0., 0., 1. ]", "0., 0., 2. ]", "'camera_matrix' is no camera matrix"},
      {"distortion_coefficients:", "lens:", "'distortion_coefficients' is missing"},
      {"cols: 5", "cols: 3", "'distortion_coefficients' says 1 × 3"},
      {"[ -0.2, 0.05, 0., 0., 0. ]", "hello", "'distortion_coefficients' holds something"},
      {"[ -0.2, 0.05, 0., 0., 0. ]", "[ -0.2, .Inf, 0., 0., 0. ]", "not finite"},
  };
  ASSERT_TRUE(parseOpenCvCalibration(kYaml, "c.yml"));
  for (const auto& [from, to, what] : cases) {
    const auto set = parseOpenCvCalibration(replaced(kYaml, from, to), "c.yml");
    ASSERT_FALSE(set) << to;
    EXPECT_THAT(set.error().what, HasSubstr(what)) << to;
    EXPECT_THAT(set.error().where, HasSubstr("c.yml"));
    EXPECT_FALSE(set.error().advice.empty()) << to;
  }
  for (const int wrong : {1, 3, 6, 7, 13}) EXPECT_FALSE(parseOpenCvCalibration(written(cameraMatrix(), lensOf(wrong)), "c.yml")) << wrong;
  EXPECT_FALSE(parseOpenCvCalibration(written(cameraMatrix(), lensOf(5), ".yml", true), "c.yml")) << "a fisheye has four";
}

TEST(OpenCvCalibration, WarnsOfASkewThatIsPassedOver) {
  const auto set = parseOpenCvCalibration(replaced(kYaml, "500., 0., 320.", "500., 2., 320."), "c.yml");
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->warnings.size(), 1u);
}

TEST(OpenCvCalibration, RefusesWhatIsNoCalibration) {
  for (const std::string& text : {std::string(), std::string("   \n"), std::string("hello"), std::string("%YAML:1.0\n"),
                                  std::string("<?xml version=\"1.0\"?>\n<opencv_storage>\n"), std::string("{"),
                                  std::string(100000, '['), "%YAML:1.0\n---\na: " + std::string(100000, '{'),
                                  "%YAML:1.0\n---\n" + std::string(100000, '-'), std::string("%YAML:1.0\n\0\n", 12),
                                  "{" + std::string(50000, '"')})
    EXPECT_FALSE(parseOpenCvCalibration(text, "c.yml"));
  std::string dashes = "%YAML:1.0\n---\na:\n", elements = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
  for (int i = 0; i < 50000; ++i) dashes += "- ", elements += "<a>";
  EXPECT_FALSE(parseOpenCvCalibration(dashes, "c.yml"));
  EXPECT_FALSE(parseOpenCvCalibration(elements, "c.xml"));
}

TEST(OpenCvCalibration, SurvivesRandomDamage) {
  const std::string whole[] = {kYaml, written(cameraMatrix(), lensOf(5), ".xml"), written(cameraMatrix(), lensOf(5), ".json")};
  std::mt19937 random(4);
  const std::string alphabet = "0123456789.-+eE[]{}<>/!&*?:,\"'#%\n\t \xff" "dr";
  for (int i = 0; i < 6000; ++i) {
    std::string text = whole[i % 3];
    for (int k = 0; k < 4; ++k) {
      const std::size_t at = random() % text.size();
      if (random() % 8 == 0) text.resize(at + 1);
      else if (random() % 4 == 0) text.insert(at, text.substr(random() % text.size(), random() % 40));
      else text[at] = alphabet[random() % alphabet.size()];
    }
    (void)parseOpenCvCalibration(text, "c");
  }
}

TEST(OpenCvCalibration, ReadsTheRoadsCalibration) {
  const std::string path = std::string(ALIDADE_SHARED_DATA_DIR) + "/road/opencv_calib.yml";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
  const auto set = OpenCvCalibrationReader().read(path, Progress());
  ASSERT_TRUE(set) << set.error().text();
  EXPECT_EQ(set->cameras[0].width, 5472);
  EXPECT_EQ(set->cameras[0].cx, 2731.4405032761174);
  EXPECT_EQ(set->cameras[0].distortion.p1, -0.000503346062832222);
  // The lens folds back at r = 1.369.
  EXPECT_NEAR(Camera(set->cameras[0]).foldBackRadius(), 1.369, 1e-3);
}

}  // namespace alidade
