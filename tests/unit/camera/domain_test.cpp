// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <numbers>

#include <gtest/gtest.h>

#include "lenses.h"

namespace alidade {
namespace {

Camera brown(std::vector<double> k) {
  std::vector<double> parameters{1000, 1000, 960, 540, k[0], k[1], 0, 0, k[2]};
  return Camera(made(CameraModel::OpenCv5, 1920, 1080, parameters));
}

TEST(FoldBack, OfTheDroneCameraIsAtItsPublishedRadius) {
  const Camera camera(droneCamera());
  EXPECT_NEAR(camera.foldBackRadius(), 1.369, 0.0005);
  EXPECT_LT(camera.imageRadius(), camera.foldBackRadius());
  EXPECT_FALSE(camera.project({1.38, 0, 1}));
  EXPECT_TRUE(camera.project({1.36, 0, 1}));
  // The fault that this guards against: a point far to the side that the formula puts into the picture.
  bool returns = false;
  for (double x = 1.4; x < 4; x += 0.05) returns = returns || camera.inPicture(camera.projectUnchecked({x, 0, 1}));
  EXPECT_TRUE(returns);
}

TEST(FoldBack, FollowsTheClosedFormOfOneCoefficient) {
  // d(r + k r³)/dr = 0 at r = 1/sqrt(-3k)
  for (const double k : {-1e-6, -0.01, -0.1, -0.35, -2.0, -1e3})
    EXPECT_NEAR(brown({k, 0, 0}).foldBackRadius() * std::sqrt(-3 * k), 1, 1e-12) << k;
  EXPECT_TRUE(std::isinf(brown({0.2, 0, 0}).foldBackRadius()));
  EXPECT_TRUE(std::isinf(brown({0, 0, 0}).foldBackRadius()));
}

TEST(FoldBack, FindsANarrowDipBetweenTwoRoots) {
  // Slope in u = r²: (u - a)(u - b)/(a b), with a and b a millionth apart.
  const double a = 0.7, b = a + 1e-6;
  const double scale = 1 / (a * b);
  const Camera camera = brown({-(a + b) * scale / 3, scale / 5, 0});
  EXPECT_NEAR(camera.foldBackRadius(), std::sqrt(a), 1e-6);
  // The roots gone complex, nothing folds: (u - a)² + c > 0.
  const double c = 1e-6, s = 1 / (a * a + c);
  EXPECT_TRUE(std::isinf(brown({-2 * a * s / 3, s / 5, 0}).foldBackRadius()));
}

TEST(FoldBack, StopsAtAPoleOfTheDenominator) {
  const Camera camera(made(CameraModel::OpenCv8, 1920, 1080, {1000, 1000, 960, 540, 0, 0, 0, 0, 0, -0.25, 0, 0}));
  EXPECT_NEAR(camera.foldBackRadius(), 2.0, 1e-9);
  EXPECT_TRUE(camera.project({1.99, 0, 1}));
  EXPECT_FALSE(camera.project({2.01, 0, 1}));
}

TEST(FoldBack, OfAFisheyeIsATangent) {
  // d(theta + k theta³)/dtheta = 0 at theta = 1/sqrt(-3k)
  const double k = -0.4;
  const Camera camera(made(CameraModel::OpenCvFisheye, 1280, 1024, {400, 400, 640, 512, k, 0, 0, 0}));
  EXPECT_NEAR(camera.foldBackRadius(), std::tan(1 / std::sqrt(-3 * k)), 1e-9);
  const Camera open(made(CameraModel::OpenCvFisheye, 1280, 1024, {400, 400, 640, 512, 0.01, 0, 0, 0}));
  EXPECT_TRUE(std::isinf(open.foldBackRadius()));
}

TEST(Domain, OfADecentredLensEndsWhereItsOwnDeterminantVanishes) {
  // x'' = x + 3 p2 x² on the axis y = 0: the Jacobian's determinant (1 + 6 p2 x)(1 + 2 p2 x) vanishes first at
  // x = -1/(6 p2), and is positive again beyond x = -1/(2 p2), where nothing may be drawn.
  const double p2 = 0.05;
  const Camera camera(made(CameraModel::OpenCv4, 1920, 1080, {1000, 1000, 960, 540, 0, 0, 0, p2}));
  EXPECT_NEAR(camera.domain().limitAlong(std::numbers::pi), 1 / (6 * p2), 1e-9);
  EXPECT_TRUE(camera.project({-3.3, 0, 1}));
  EXPECT_FALSE(camera.project({-3.4, 0, 1}));
  EXPECT_FALSE(camera.project({-12, 0, 1}));
  EXPECT_TRUE(camera.project({12, 0, 1}));
}

TEST(ImageRadius, IsTheFarthestDirectionOfAnyPixel) {
  for (const NamedCamera& named : lensCatalogue()) {
    const Camera camera(named.intrinsics);
    double farthest = 0;
    for (int v = 0; v <= 60; ++v)
      for (int u = 0; u <= 60; ++u)
        if (const auto ray = camera.unproject({-0.5 + u / 60.0 * camera.width(), -0.5 + v / 60.0 * camera.height()}))
          farthest = std::max(farthest, std::hypot(ray->x, ray->y));
    EXPECT_GE(camera.imageRadius(), farthest * (1 - 1e-6)) << named.name;
    if (std::isfinite(camera.foldBackRadius())) {
      EXPECT_LE(camera.imageRadius(), camera.foldBackRadius()) << named.name;
    }
    if (std::isfinite(camera.imageRadius()) && camera.imageRadius() < camera.foldBackRadius()) {
      EXPECT_LE(camera.imageRadius(), farthest * 1.05) << named.name;
    }
  }
}

TEST(Sees, IsTrueExactlyForDirectionsThatProjectIntoThePicture) {
  for (const NamedCamera& named : lensCatalogue()) {
    const Camera camera(named.intrinsics);
    int seen = 0;
    for (double x = -4; x <= 4; x += 0.05)
      for (double y = -4; y <= 4; y += 0.05) {
        const auto pixel = camera.project({x, y, 1});
        EXPECT_EQ(camera.sees(x, y), pixel && camera.inPicture(*pixel));
        seen += camera.sees(x, y);
      }
    EXPECT_GT(seen, 50) << named.name;
  }
}

TEST(Picture, CoversHalfAPixelAroundItsOutermostCentres) {
  const Camera camera(made(CameraModel::Pinhole, 640, 480, {500, 500, 320, 240}));
  EXPECT_TRUE(camera.inPicture({-0.5, -0.5}));
  EXPECT_TRUE(camera.inPicture({639.49, 479.49}));
  EXPECT_FALSE(camera.inPicture({-0.51, 0}));
  EXPECT_FALSE(camera.inPicture({639.5, 0}));
  EXPECT_FALSE(camera.inPicture({0, 479.5}));
}

TEST(UndistortionMask, OfAPinholeOfTheSameSizeIsFull) {
  const Camera camera(made(CameraModel::Pinhole, 64, 48, {50, 50, 31.5, 23.5}));
  const Image<unsigned char> mask = camera.undistortionMask(64, 48);
  for (std::size_t i = 0; i < mask.size(); ++i) EXPECT_EQ(mask.data()[i], 255);
}

TEST(UndistortionMask, GrowsUntilEveryBorderPixelOfThePictureFits) {
  for (const NamedCamera& named : lensCatalogue()) {
    const Camera camera(named.intrinsics);
    const Intrinsics pinhole = camera.maskPinhole(300, 200);
    for (int i = 0; i <= 100; ++i) {
      const double u = -0.5 + camera.width() * i / 100.0, v = -0.5 + camera.height() * i / 100.0;
      for (const glm::dvec2 pixel : {glm::dvec2(u, -0.5), glm::dvec2(u, camera.height() - 0.5), glm::dvec2(-0.5, v),
                                     glm::dvec2(camera.width() - 0.5, v)}) {
        const auto ray = camera.unproject(pixel);
        if (!ray || std::hypot(ray->x, ray->y) > std::tan(80 * std::numbers::pi / 180)) continue;
        const glm::dvec2 at(pinhole.fx * ray->x + pinhole.cx, pinhole.fy * ray->y + pinhole.cy);
        EXPECT_GE(at.x, -0.51) << named.name;
        EXPECT_LE(at.x, 299.51) << named.name;
        EXPECT_GE(at.y, -0.51) << named.name;
        EXPECT_LE(at.y, 199.51) << named.name;
      }
    }
  }
}

}  // namespace
}  // namespace alidade
