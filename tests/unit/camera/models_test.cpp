// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// COLMAP's models by their published formulas (colmap.github.io/cameras.html), and the high-order Brown form
// by its closed form, each written out here a second time.

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lenses.h"

namespace alidade {
namespace {

using Formula = glm::dvec2 (*)(const std::vector<double>&, double, double);

struct Published {
  CameraModel model;
  std::string name;
  std::vector<double> parameters;
  Formula formula;
};

const std::vector<Published>& publishedModels() {
  using P = const std::vector<double>&;
  using enum CameraModel;
  static const std::vector<Published> all{
      {SimplePinhole, "SIMPLE_PINHOLE", {500, 320, 240},
       [](P p, double x, double y) { return glm::dvec2(p[0] * x + p[1], p[0] * y + p[2]); }},
      {Pinhole, "PINHOLE", {500, 510, 320, 240},
       [](P p, double x, double y) { return glm::dvec2(p[0] * x + p[2], p[1] * y + p[3]); }},
      {SimpleRadial, "SIMPLE_RADIAL", {500, 320, 240, -0.03},
       [](P p, double x, double y) {
         const double radial = 1 + p[3] * (x * x + y * y);
         return glm::dvec2(p[0] * x * radial + p[1], p[0] * y * radial + p[2]);
       }},
      {Radial, "RADIAL", {500, 320, 240, -0.03, 0.007},
       [](P p, double x, double y) {
         const double r2 = x * x + y * y, radial = 1 + p[3] * r2 + p[4] * r2 * r2;
         return glm::dvec2(p[0] * x * radial + p[1], p[0] * y * radial + p[2]);
       }},
      {OpenCv4, "OPENCV", {500, 510, 320, 240, -0.03, 0.007, 0.002, -0.003},
       [](P p, double x, double y) {
         const double r2 = x * x + y * y, radial = 1 + p[4] * r2 + p[5] * r2 * r2;
         return glm::dvec2(p[0] * (x * radial + 2 * p[6] * x * y + p[7] * (r2 + 2 * x * x)) + p[2],
                           p[1] * (y * radial + 2 * p[7] * x * y + p[6] * (r2 + 2 * y * y)) + p[3]);
       }},
      {OpenCv8, "FULL_OPENCV", {500, 510, 320, 240, -0.03, 0.007, 0.002, -0.003, 0.001, 0.02, -0.01, 0.004},
       [](P p, double x, double y) {
         const double r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
         const double radial = (1 + p[4] * r2 + p[5] * r4 + p[8] * r6) / (1 + p[9] * r2 + p[10] * r4 + p[11] * r6);
         return glm::dvec2(p[0] * (x * radial + 2 * p[6] * x * y + p[7] * (r2 + 2 * x * x)) + p[2],
                           p[1] * (y * radial + 2 * p[7] * x * y + p[6] * (r2 + 2 * y * y)) + p[3]);
       }},
      {OpenCvFisheye, "OPENCV_FISHEYE", {500, 510, 320, 240, -0.03, 0.007, 0.002, -0.003},
       [](P p, double x, double y) {
         const double r = std::hypot(x, y), theta = std::atan(r), t2 = theta * theta;
         const double bent = theta * (1 + p[4] * t2 + p[5] * t2 * t2 + p[6] * t2 * t2 * t2 + p[7] * t2 * t2 * t2 * t2);
         const double scale = r > 0 ? bent / r : 1;
         return glm::dvec2(p[0] * x * scale + p[2], p[1] * y * scale + p[3]);
       }},
      {BrownHighOrder, "BROWN_HIGH_ORDER",
       {500,   510,  320,  240,   -0.03, 0.007, 0.001, -2e-3, 5e-4, -1e-4, 0.02,
        -0.01, 0.004, 0.002, -0.003, 0.1,   -0.05, 0.02,  0.01, 0.003, -0.002},
       [](P p, double x, double y) {
         const double r2 = x * x + y * y;
         const auto power = [&](int n) { return std::pow(r2, n); };
         double numerator = 1, denominator = 1, growth = 1;
         for (int i = 0; i < 6; ++i) numerator += p[4 + i] * power(i + 1);
         for (int i = 0; i < 3; ++i) denominator += p[10 + i] * power(i + 1);
         for (int i = 0; i < 4; ++i) growth += p[15 + i] * power(i + 1);
         const double radial = numerator / denominator, t1 = p[13], t2 = p[14];
         const double xd = x * radial + (2 * t1 * x * y + t2 * (r2 + 2 * x * x)) * growth + p[19] * x + p[20] * y;
         const double yd = y * radial + (t1 * (r2 + 2 * y * y) + 2 * t2 * x * y) * growth;
         return glm::dvec2(p[0] * xd + p[2], p[1] * yd + p[3]);
       }},
      // Metashape's manual, "Frame cameras": u = w/2 + cx + x' f + x' b1 + y' b2; fx = f + b1, p[12] = b2 / fx.
      {BrownSkewed, "BROWN_SKEWED", {500, 510, 320, 240, -0.03, 0.007, 0.001, -2e-3, 0.002, -0.003, 0.1, -0.05, 0.004},
       [](P p, double x, double y) {
         const double r2 = x * x + y * y, r4 = r2 * r2;
         const double radial = 1 + p[4] * r2 + p[5] * r4 + p[6] * r4 * r2 + p[7] * r4 * r4;
         const double growth = 1 + p[10] * r2 + p[11] * r4, b2 = p[12] * p[0];
         const double xd = x * radial + (2 * p[8] * x * y + p[9] * (r2 + 2 * x * x)) * growth;
         const double yd = y * radial + (p[8] * (r2 + 2 * y * y) + 2 * p[9] * x * y) * growth;
         return glm::dvec2(p[0] * xd + b2 * yd + p[2], p[1] * yd + p[3]);
       }},
  };
  return all;
}

TEST(CameraModels, FollowTheirPublishedFormulas) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> side(-0.9, 0.9);
  for (const Published& published : publishedModels()) {
    const auto made = Intrinsics::fromParameters(published.model, 640, 480, published.parameters);
    ASSERT_TRUE(made) << published.name;
    const Camera camera(*made);
    for (int i = 0; i < 500; ++i) {
      const double x = side(random), y = side(random), z = 1 + 9 * std::abs(side(random));
      const auto pixel = camera.project({x * z, y * z, z});
      const glm::dvec2 wanted = published.formula(published.parameters, x, y);
      ASSERT_TRUE(pixel) << published.name;
      EXPECT_NEAR(pixel->x, wanted.x, 1e-9 * 640) << published.name;
      EXPECT_NEAR(pixel->y, wanted.y, 1e-9 * 640) << published.name;
    }
    const auto axis = camera.project({0, 0, 5});
    ASSERT_TRUE(axis);
    EXPECT_EQ(*axis, glm::dvec2(made->cx, made->cy)) << published.name;
  }
}

TEST(CameraModels, HighOrderBrownWithFiveCoefficientsIsTheFiveCoefficientModel) {
  const Camera five(made(CameraModel::OpenCv5, 1920, 1080, {1400, 1390, 955, 545, -0.28, 0.09, 1e-3, -7e-4, -0.01}));
  const Camera high(made(CameraModel::BrownHighOrder, 1920, 1080,
                         {1400, 1390, 955, 545, -0.28, 0.09, -0.01, 0, 0, 0, 0, 0, 0, 1e-3, -7e-4, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(five.lens().kind, high.lens().kind);
  EXPECT_EQ(five.foldBackRadius(), high.foldBackRadius());
  for (double x = -0.7; x < 0.7; x += 0.1)
    for (double y = -0.4; y < 0.4; y += 0.1) EXPECT_EQ(five.projectUnchecked({x, y, 1}), high.projectUnchecked({x, y, 1}));
}

TEST(CameraModels, GiveBackTheParametersAndNamesThatTheyTook) {
  for (const NamedCamera& camera : lensCatalogue()) {
    const Intrinsics& in = camera.intrinsics;
    EXPECT_EQ(static_cast<int>(in.parameters().size()), parameterCount(in.model)) << camera.name;
    const auto again = Intrinsics::fromParameters(in.model, in.width, in.height, in.parameters());
    ASSERT_TRUE(again);
    EXPECT_EQ(again->parameters(), in.parameters());
    EXPECT_EQ(Camera(*again).projectUnchecked({0.3, -0.2, 1}), Camera(in).projectUnchecked({0.3, -0.2, 1}));
    EXPECT_EQ(parseCameraModel(cameraModelName(in.model)), in.model);
  }
  for (const Published& published : publishedModels()) EXPECT_EQ(cameraModelName(published.model), published.name);
  EXPECT_EQ(parseCameraModel("THIN_PRISM_FISHEYE"), std::nullopt);
  EXPECT_EQ(parseCameraModel(""), std::nullopt);
}

TEST(CameraModels, ACalibrationThatCannotBeIsRefusedWithEveryReason) {
  using testing::HasSubstr;
  const auto refused = [](CameraModel model, int w, int h, std::vector<double> parameters) {
    const auto made = Intrinsics::fromParameters(model, w, h, parameters);
    return made ? std::string("accepted") : made.error().text();
  };
  const double nan = std::nan("");
  EXPECT_THAT(refused(CameraModel::Pinhole, 640, 480, {1, 2, 3}), HasSubstr("takes 4 parameters, 3 were given"));
  EXPECT_THAT(refused(CameraModel::Pinhole, 0, 480, {500, 500, 320, 240}), HasSubstr("size 0×480"));
  EXPECT_THAT(refused(CameraModel::Pinhole, 640, -1, {500, 500, 320, 240}), HasSubstr("size 640×-1"));
  EXPECT_THAT(refused(CameraModel::Pinhole, 640, 480, {0, 500, 320, 240}), HasSubstr("focal length"));
  EXPECT_THAT(refused(CameraModel::Pinhole, 640, 480, {-500, -500, 320, 240}), HasSubstr("not positive"));
  EXPECT_THAT(refused(CameraModel::Pinhole, 640, 480, {nan, 500, 320, 240}), HasSubstr("not a finite number"));
  EXPECT_THAT(refused(CameraModel::SimpleRadial, 640, 480, {500, 320, 240, INFINITY}), HasSubstr("coefficient"));
  EXPECT_THAT(refused(CameraModel::Pinhole, 0, 480, {0, 500, 320, 240}), HasSubstr("; "));
}

TEST(ScaledCamera, SeesTheSameDirectionAtTheScaledPlaceOfThePicture) {
  for (const NamedCamera& named : lensCatalogue()) {
    const Camera camera(named.intrinsics);
    const Camera half = camera.scaledTo(camera.width() / 2, camera.height() / 4);
    const glm::dvec3 p(0.2, -0.1, 1);
    const glm::dvec2 full = *camera.project(p), scaled = *half.project(p);
    // The picture's corner, half a pixel from the first pixel's centre, stays where it is.
    EXPECT_NEAR((full.x + 0.5) / camera.width(), (scaled.x + 0.5) / half.width(), 1e-12);
    EXPECT_NEAR((full.y + 0.5) / camera.height(), (scaled.y + 0.5) / half.height(), 1e-12);
    EXPECT_EQ(camera.imageRadius(), half.imageRadius());
  }
}

}  // namespace
}  // namespace alidade
