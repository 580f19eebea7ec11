// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// OpenCV is the oracle for the models that carry its name.

#include <random>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "lenses.h"

namespace alidade {
namespace {

cv::Mat cameraMatrix(const Intrinsics& in) {
  return (cv::Mat_<double>(3, 3) << in.fx, 0, in.cx, 0, in.fy, in.cy, 0, 0, 1);
}

std::vector<double> openCvCoefficients(const Intrinsics& in) {
  const std::vector<double> all = in.parameters();
  return {all.begin() + 4, all.end()};
}

bool hasOpenCvModel(CameraModel model) {
  using enum CameraModel;
  return model == OpenCv4 || model == OpenCv5 || model == OpenCv8 || model == OpenCv12 || model == OpenCv14;
}

std::vector<NamedCamera> where(bool (*wanted)(const NamedCamera&)) {
  std::vector<NamedCamera> found;
  for (const NamedCamera& camera : lensCatalogue())
    if (wanted(camera)) found.push_back(camera);
  return found;
}

std::vector<cv::Point3d> randomPoints(double widest) {
  std::mt19937_64 random(20260101);
  std::uniform_real_distribution<double> side(-widest, widest), depth(0.5, 80);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 2000; ++i) {
    const double z = depth(random);
    points.emplace_back(side(random) * z, side(random) * z, z);
  }
  points.emplace_back(0, 0, 3);
  return points;
}

/// 1e-9 of the pixel coordinate or of the picture's size, whichever is larger.
void expectSame(const Camera& camera, const std::vector<cv::Point3d>& points, const std::vector<cv::Point2d>& oracle) {
  int compared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 p(points[i].x, points[i].y, points[i].z);
    const glm::dvec2 pixel = camera.projectUnchecked(p);
    const double scale = std::max({1.0 * camera.width(), std::abs(oracle[i].x), std::abs(oracle[i].y)});
    EXPECT_NEAR(pixel.x, oracle[i].x, 1e-9 * scale) << points[i];
    EXPECT_NEAR(pixel.y, oracle[i].y, 1e-9 * scale) << points[i];
    if (const auto checked = camera.project(p)) {
      EXPECT_EQ(*checked, pixel);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

class AgainstProjectPoints : public testing::TestWithParam<NamedCamera> {};

TEST_P(AgainstProjectPoints, PixelsAgreeWithinOneBillionth) {
  const Intrinsics& in = GetParam().intrinsics;
  const std::vector<cv::Point3d> points = randomPoints(1.0);
  std::vector<cv::Point2d> oracle;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), cameraMatrix(in), openCvCoefficients(in), oracle);
  expectSame(Camera(in), points, oracle);
}

INSTANTIATE_TEST_SUITE_P(Lenses, AgainstProjectPoints,
                         testing::ValuesIn(where([](const NamedCamera& c) { return hasOpenCvModel(c.intrinsics.model); })),
                         TestNamer());

class AgainstFisheye : public testing::TestWithParam<NamedCamera> {};

TEST_P(AgainstFisheye, PixelsAgreeWithinOneBillionth) {
  const Intrinsics& in = GetParam().intrinsics;
  const std::vector<cv::Point3d> points = randomPoints(6.0);
  std::vector<cv::Point2d> oracle;
  cv::fisheye::projectPoints(points, oracle, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), cameraMatrix(in),
                             openCvCoefficients(in));
  expectSame(Camera(in), points, oracle);
}

INSTANTIATE_TEST_SUITE_P(Lenses, AgainstFisheye,
                         testing::ValuesIn(where([](const NamedCamera& c) { return c.intrinsics.distortion.fisheye; })),
                         TestNamer());

/// cv::undistort's own map, on the mask's pinhole: where it reads a pixel of the picture, the mask is set.
/// OpenCV knows no fold-back, so pixels beyond it are the one allowed difference.
TEST(UndistortionMask, AgreesWithTheMapOfOpenCvUndistort) {
  for (const NamedCamera& named : where([](const NamedCamera& c) { return hasOpenCvModel(c.intrinsics.model); })) {
    const Camera camera(named.intrinsics);
    const int width = 320, height = 200;
    const Intrinsics pinhole = camera.maskPinhole(width, height);
    const Image<unsigned char> mask = camera.undistortionMask(width, height);
    cv::Mat mapX, mapY;
    cv::initUndistortRectifyMap(cameraMatrix(named.intrinsics), openCvCoefficients(named.intrinsics), cv::Mat(),
                                cameraMatrix(pinhole), cv::Size(width, height), CV_32FC1, mapX, mapY);
    int set = 0, wrong = 0, folded = 0;
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const double x = (u - pinhole.cx) / pinhole.fx, y = (v - pinhole.cy) / pinhole.fy;
        const glm::dvec2 pixel(mapX.at<float>(v, u), mapY.at<float>(v, u));
        set += mask.at(u, v) == 255;
        if (!camera.domain().contains(x, y)) {
          folded += camera.inPicture(pixel);
          EXPECT_EQ(mask.at(u, v), 0);
          continue;
        }
        // Half a pixel of rounding in OpenCV's float map decides nothing here.
        const bool nearBorder = camera.inPicture(pixel + 0.01) != camera.inPicture(pixel - 0.01);
        if (!nearBorder) wrong += camera.inPicture(pixel) != (mask.at(u, v) == 255);
      }
    EXPECT_EQ(wrong, 0) << named.name;
    EXPECT_GT(set, width * height / 4) << named.name;
    if (named.name == "StrongBarrelFoldsInsidePicture") {
      EXPECT_GT(folded, 0);
    }
  }
}

}  // namespace
}  // namespace alidade
