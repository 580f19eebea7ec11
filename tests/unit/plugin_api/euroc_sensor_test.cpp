// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/euroc_sensor.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "plugin_api/text_file.h"

namespace alidade {

using testing::HasSubstr;

namespace {

/// The fuzz target's seed: written after Burri et al. (2016) and the published calibration of the data sets' left camera.
std::string sensor() {
  const auto text = readTextFile((std::filesystem::path(ALIDADE_FUZZ_CORPUS_DIR) / "opencv-calib/euroc_sensor.yaml").string());
  EXPECT_TRUE(text);
  return text.value_or(std::string());
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST(EurocSensor, ProjectsAsOpenCvDoesWithItsNumbers) {
  const auto made = parseEurocSensor(sensor(), "sensor.yaml");
  ASSERT_TRUE(made) << made.error().text();
  const Camera camera(made->intrinsics);
  EXPECT_EQ(camera.width(), 752);
  EXPECT_EQ(camera.height(), 480);
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1);
  const cv::Mat lens = (cv::Mat_<double>(1, 4) << -0.28340811, 0.07395907, 0.00019359, 1.76187114e-05);
  for (const cv::Point3d p : {cv::Point3d(0.1, 0.2, 1), cv::Point3d(-0.3, 0.15, 1.2), cv::Point3d(0.25, -0.2, 0.9)}) {
    std::vector<cv::Point2d> expected;
    cv::projectPoints(std::vector<cv::Point3d>{p}, cv::Vec3d(), cv::Vec3d(), matrix, lens, expected);
    const auto pixel = camera.project({p.x, p.y, p.z});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x, expected[0].x, 1e-9);
    EXPECT_NEAR(pixel->y, expected[0].y, 1e-9);
  }
}

TEST(EurocSensor, TheMatrixIsBodyFromCamera) {
  const auto made = parseEurocSensor(sensor(), "sensor.yaml");
  ASSERT_TRUE(made);
  EXPECT_EQ(made->bodyFromSensor.translation, glm::dvec3(-0.0216401454975, -0.064676986768, 0.00981073058949));
  // The third column: where the optical axis points on the body.
  const glm::dvec3 ahead = made->bodyFromSensor.rotation * glm::dvec3(0, 0, 1);
  EXPECT_LT(glm::length(ahead - glm::dvec3(0.00414029679422, 0.025715529948, 0.999660727178)), 1e-9);
}

TEST(EurocSensor, AFisheyeIsEquidistant) {
  const auto made = parseEurocSensor(replaced(sensor(), "radial-tangential", "equidistant"), "sensor.yaml");
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->intrinsics.model, CameraModel::OpenCvFisheye);
}

TEST(EurocSensor, WhatIsWrongIsNamed) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"sensor_type: camera", "sensor_type: imu", "no camera but"},
      {"camera_model: pinhole", "camera_model: omni", "camera_model"},
      {"radial-tangential", "fov", "distortion_model"},
      {"resolution: [752, 480]", "resolution: [752]", "'resolution'"},
      {"resolution: [752, 480]", "resolution: [0, 480]", "impossible"},
      {"458.654", "nan", "not finite"},
      {"458.654", "-458.654", ""},
      {"[-0.28340811, 0.07395907, ", "[", "'distortion_coefficients'"},
      {"T_BS:", "T_SB:", "'T_BS.data' is missing"},
      {"-0.999880929698", "0.999880929698", "no rigid transform"},
      {"0.0, 0.0, 0.0, 1.0]", "0.0, 0.0, 0.0, 2.0]", "no rigid transform"},
      {"0.0, 0.0, 0.0, 1.0]", "0.0, 0.0, 1.0]", "'T_BS.data' is not a list"}};
  const std::string whole = sensor();
  for (const auto& [from, to, says] : cases) {
    const auto made = parseEurocSensor(replaced(whole, from, to), "sensor.yaml");
    ASSERT_FALSE(made) << to;
    EXPECT_THAT(made.error().text(), HasSubstr(says));
    EXPECT_THAT(made.error().text(), HasSubstr("sensor.yaml"));
  }
  // All that is needed ends with the last number's first digits.
  for (std::size_t size = 0; size + 20 < whole.size(); size += 7)
    EXPECT_FALSE(parseEurocSensor(whole.substr(0, size), "sensor.yaml")) << size;
}

}  // namespace alidade
