// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <gtest/gtest.h>

#include "raster/splat_pass.h"
#include "raster/splatter.h"
#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

using test::storeFrom;
using test::unevenRoom;

const RigidTransform kView = RigidTransform::cameraLookingAt({3, 2, 1.6}, {17, 10, 1.2});

std::vector<Camera> lenses() {
  const double f = 420, cx = 318.2, cy = 241.7;
  std::vector<Camera> cameras;
  for (const auto& [model, parameters] : std::initializer_list<std::pair<CameraModel, std::vector<double>>>{
           {CameraModel::Pinhole, {f, f + 3, cx, cy}},
           {CameraModel::OpenCv5, {f, f, cx, cy, -0.31, 0.12, 0.001, -0.002, -0.03}},
           {CameraModel::OpenCv5, {f, f, cx, cy, 0.2, 0.1, 0.001, -0.002, 0.05}},
           {CameraModel::OpenCvFisheye, {f * 0.6, f * 0.6, cx, cy, -0.02, 0.004, -0.001, 0.0002}}})
    cameras.emplace_back(*Intrinsics::fromParameters(model, 640, 480, parameters));
  return cameras;
}

/// Largest distance, pixels, between a point's place and where 2/R - z/R² puts it, over every point in the
/// picture of the runs that are drawn so; in double, through the camera's own projection. And how many points
/// that are.
struct Moved {
  double mostPx = 0;
  std::size_t points = 0;
};

Moved movedByMultiplyAdd(const PointStore& store, const Camera& camera, const SplatOptions& options) {
  Moved moved;
  const SplatView base = baseView(camera, options);
  for (const SelectedRange& range : selectAll(store, camera, kView).ranges) {
    const SplatRun run = makeRun(store, range, kView, base, options);
    if (run.view.reciprocal != Reciprocal::MultiplyAdd) continue;
    const CloudNode& node = store.nodes()[range.node];
    for (std::uint32_t i = 0; i < range.count; ++i) {
      const DisplayPoint& p = run.points[i];
      const glm::dvec3 at = kView * (node.origin + glm::dvec3(p.x, p.y, p.z) * node.step);
      const double inverse = run.view.twoOverR - at.z * run.view.overRSquared;
      const auto exact = camera.project(at);
      const auto approximate = camera.project({at.x * inverse, at.y * inverse, 1.0});
      if (!exact || !approximate) continue;
      const auto inPicture = [&](const glm::dvec2& pixel) {
        return pixel.x > -0.5 && pixel.y > -0.5 && pixel.x < camera.width() - 0.5 &&
               pixel.y < camera.height() - 0.5;
      };
      if (!inPicture(*exact) && !inPicture(*approximate)) continue;
      moved.mostPx = std::max(moved.mostPx, glm::length(*exact - *approximate));
      ++moved.points;
    }
  }
  return moved;
}

TEST(Reciprocal, MultiplyAddMovesNoPointFartherThanAllowed) {
  const auto store = storeFrom(unevenRoom(400'000), 500);
  for (const Camera& camera : lenses()) {
    std::size_t before = 0;
    for (const double allowed : {0.05, 0.5, 5.0}) {
      const Moved moved = movedByMultiplyAdd(
          *store, camera,
          {.maximumSizePx = 1.0, .reciprocal = Reciprocal::MultiplyAdd, .reciprocalErrorPx = allowed});
      EXPECT_LE(moved.mostPx, allowed);
      // The bound is not idle: what it lets through comes near it.
      EXPECT_GT(moved.mostPx, 0.1 * allowed);
      EXPECT_GT(moved.points, before);
      before = moved.points;
    }
  }
}

/// Per cent of the pixels that two pictures do not share.
double differing(const SplatImages& a, const SplatImages& b) {
  std::size_t covered = 0, different = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    covered += std::isfinite(a.depth.data()[i]);
    different += a.depth.data()[i] != b.depth.data()[i];
  }
  return 100.0 * static_cast<double>(different) / static_cast<double>(covered);
}

TEST(Reciprocal, EachKindDrawsThePictureOfTheDivision) {
  const auto store = storeFrom(unevenRoom(400'000), 500);
  for (const Camera& camera : lenses()) {
    const std::vector<SplatLayer> layers{{store, selectAll(*store, camera, kView)}};
    const SplatImages divided = splat(layers, camera, kView, {.maximumSizePx = 1.0});
    const auto with = [&](Reciprocal kind, double errorPx) {
      return splat(layers, camera, kView,
                   {.maximumSizePx = 1.0, .reciprocal = kind, .reciprocalErrorPx = errorPx});
    };
    // A ten-thousandth of a pixel takes a few of the points that lie on a border across it; 0.05 px takes at
    // most 2 × 0.05 in each axis.
    EXPECT_LT(differing(divided, with(Reciprocal::Newton, 0)), 0.2);
    const double few = differing(divided, with(Reciprocal::MultiplyAdd, 0.05));
    EXPECT_GT(few, 0.0);
    EXPECT_LT(few, 10.0);
    EXPECT_GT(differing(divided, with(Reciprocal::MultiplyAdd, 5.0)), few);
  }
}

}  // namespace
}  // namespace alidade
