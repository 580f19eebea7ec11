// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Our files, read by OpenCV's own FileStorage and by the plugin that reads calibrations.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "io/calibration_writer.h"
#include "opencv-calib/opencv_calibration_reader.h"
#include "test_folder.h"

namespace alidade {
namespace {

using testing::HasSubstr;

Intrinsics lensOf(CameraModel model, const std::vector<double>& parameters) {
  return Intrinsics::fromParameters(model, 1280, 960, parameters).value();
}

const Intrinsics kFive = lensOf(CameraModel::OpenCv5, {560.1947123456789, 561.25, 651.1, 498.9, -0.2327, 0.0616, -4e-5, 5.3e-5, -0.0075});

TEST(CalibrationWriter, OpenCvReadsEveryNumberBackBitForBit) {
  const TestFolder folder;
  for (const char* ending : {".yml", ".xml", ".json"}) {
    const std::string path = folder / (std::string("camera") + ending);
    ASSERT_TRUE(writeCalibration(kFive, {0.524, 35}, path));
    cv::FileStorage file(path, cv::FileStorage::READ);
    cv::Mat matrix, lens;
    file["camera_matrix"] >> matrix;
    file["distortion_coefficients"] >> lens;
    ASSERT_EQ(matrix.total(), 9u) << ending;
    ASSERT_EQ(lens.total(), 5u) << ending;
    EXPECT_EQ(matrix.at<double>(0, 0), kFive.fx);
    EXPECT_EQ(matrix.at<double>(1, 2), kFive.cy);
    EXPECT_EQ(lens.at<double>(4), kFive.distortion.k[2]);
    EXPECT_EQ(static_cast<int>(file["image_width"]), 1280);
    EXPECT_EQ(static_cast<int>(file["nframes"]), 35);
    EXPECT_EQ(static_cast<double>(file["avg_reprojection_error"]), 0.524);
  }
}

TEST(CalibrationWriter, OurReaderReadsEveryModelOfOpenCvBack) {
  const TestFolder folder;
  const std::vector<Intrinsics> lenses{
      lensOf(CameraModel::OpenCv4, {560, 561, 651, 498, -0.2, 0.06, 5e-4, -7e-4}), kFive,
      lensOf(CameraModel::OpenCv8, {560, 561, 651, 498, 0.3, -0.1, 5e-4, -7e-4, 0.02, 0.5, -0.05, 0.03}),
      lensOf(CameraModel::OpenCv14, {560, 561, 651, 498, 0.3, -0.1, 5e-4, -7e-4, 0.02, 0.5, -0.05, 0.03, 2e-3, -1e-3, 1e-3, 3e-3, 0.02, -0.01}),
      lensOf(CameraModel::OpenCvFisheye, {560, 561, 651, 498, -0.02, 0.01, -0.004, 0.0005})};
  for (const Intrinsics& lens : lenses)
    for (const char* ending : {".yml", ".xml", ".json"}) {
      const std::string path = folder / (std::string("camera") + ending);
      ASSERT_TRUE(writeCalibration(lens, {}, path));
      const auto read = OpenCvCalibrationReader().read(path, {});
      ASSERT_TRUE(read) << read.error().text();
      EXPECT_EQ(read->cameras[0].model, lens.model);
      EXPECT_EQ(read->cameras[0].parameters(), lens.parameters()) << ending;
    }
}

TEST(CalibrationWriter, ASimpleLensIsSaidInFourCoefficientsAndInColmapsWords) {
  const TestFolder folder;
  const Intrinsics lens = lensOf(CameraModel::SimpleRadial, {560, 651, 498, -0.2});
  ASSERT_TRUE(writeCalibration(lens, {}, folder / "camera.yml"));
  const auto read = OpenCvCalibrationReader().read(folder / "camera.yml", {});
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->cameras[0].parameters(), (std::vector<double>{560, 560, 651, 498, -0.2, 0, 0, 0}));
  ASSERT_TRUE(writeCalibration(lens, {}, folder / "cameras.txt"));
  std::ifstream file(folder / "cameras.txt");
  std::string remark, line;
  std::getline(file, remark);
  std::getline(file, line);
  EXPECT_EQ(line, "1 SIMPLE_RADIAL 1280 960 560 651.5 498.5 -0.2");
}

TEST(CalibrationWriter, WhatAFormatCannotSayIsRefusedByName) {
  const TestFolder folder;
  const Intrinsics skewed = lensOf(CameraModel::BrownSkewed, {560, 561, 651, 498, -0.2, 0.06, -0.01, 0.002, 5e-4, -7e-4, 0.1, 0.05, 3e-4});
  const auto refused = writeCalibration(skewed, {}, folder / "camera.yml");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("coefficient k4"));
  EXPECT_FALSE(std::filesystem::exists(folder / "camera.yml"));
  EXPECT_THAT(writeCalibration(kFive, {}, folder / "camera.doc").error().what, HasSubstr("'.doc'"));
}

}  // namespace
}  // namespace alidade
