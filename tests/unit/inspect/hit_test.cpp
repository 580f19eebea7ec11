// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "inspect/hit.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace alidade {

namespace {

Camera distortedCamera() {
  Intrinsics in;
  in.model = CameraModel::OpenCv5;
  in.width = 640;
  in.height = 480;
  in.fx = in.fy = 500;
  in.cx = 320;
  in.cy = 240;
  in.distortion.k[0] = -0.2;
  in.distortion.k[1] = 0.05;
  return Camera(in);
}

}  // namespace

TEST(Hit, APixelOfAProjectedPointGivesThatPointBackAtSurveyCoordinates) {
  const Camera camera = distortedCamera();
  const glm::dvec3 point(2'683'507.25, 1'247'830.5, 414.125);
  const auto pose = RigidTransform::cameraLookingAt({2'683'500, 1'247'800, 413}, point + glm::dvec3(3, 1, -1));
  const glm::dvec3 inCamera = pose * point;
  const auto pixel = camera.project(inCamera);
  ASSERT_TRUE(pixel);
  const DepthImage depth(640, 480, static_cast<float>(inCamera.z));
  const auto hit = hitAt(depth, camera, pose, *pixel);
  ASSERT_TRUE(hit);
  EXPECT_LT(glm::length(hit->world - point), 1e-5);  // the depth picture is float
  EXPECT_NEAR(hit->distanceM, glm::length(inCamera), 1e-5);
  EXPECT_FALSE(hit->sigmaM) << "an unknown pose quality must not pass for a good one";
}

TEST(Hit, UnknownDepthAndPixelsOutsideGiveNothing) {
  const Camera camera = distortedCamera();
  DepthImage depth(640, 480, std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(hitAt(depth, camera, {}, {320, 240}));
  depth.fill(std::numeric_limits<float>::infinity());
  EXPECT_FALSE(hitAt(depth, camera, {}, {320, 240}));
  depth.fill(5.0f);
  EXPECT_FALSE(hitAt(depth, camera, {}, {-3, 240}));
  EXPECT_FALSE(hitAt(depth, camera, {}, {std::numeric_limits<double>::quiet_NaN(), 240}));
  EXPECT_TRUE(hitAt(depth, camera, {}, {320, 240}));
}

TEST(Hit, UncertaintyAddsPoseAndSampling) {
  HitUncertainty uncertainty;
  uncertainty.pose = PoseQuality{};
  uncertainty.pose->positionStdM = {0.003, 0.0, 0.004};  // 5 mm
  uncertainty.pose->rotationStdRad = {0.0, 0.0012, 0.0};  // 12 mm at 10 m
  uncertainty.scanSpacingM = 0.0;
  const auto hit = hitAt(DepthImage(640, 480, 10.0f), distortedCamera(), {}, {320, 240}, uncertainty);
  ASSERT_TRUE(hit && hit->sigmaM);
  EXPECT_NEAR(*hit->sigmaM, 0.013, 1e-9);
}

TEST(Measure, IsInTheSurveyorsTerms) {
  Hit a, b;
  a.world = {100, 200, 10};
  b.world = {97, 204, 22};
  const auto m = measure(a, b);
  EXPECT_DOUBLE_EQ(m.horizontalM, 5);
  EXPECT_DOUBLE_EQ(m.slopeM, 13);
  EXPECT_DOUBLE_EQ(m.heightM, 12);
  EXPECT_NEAR(m.azimuthRad, 2 * std::numbers::pi - std::atan2(3, 4), 1e-12);
}

TEST(StakeOut, TellsCutFromFillAndHoldsTheTolerance) {
  const StakePoint point{"P1", {10, 20, 5}, "", 0.02};
  const auto delta = stakeOutDelta(point, {10.012, 20.016, 5.3});
  EXPECT_NEAR(delta.horizontalM, 0.02, 1e-12);
  EXPECT_NEAR(delta.cutM, 0.3, 1e-12);
  EXPECT_FALSE(stakeOutDelta(point, {10.03, 20, 5}).within);
  EXPECT_TRUE(stakeOutDelta(point, {10.01, 20, 4}).within);
}

}  // namespace alidade
