// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splatter.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

using test::pinhole;
using test::storeFrom;
using test::unevenRoom;

/// Chooses a kernel for a scope.
class ForcedKernel {
 public:
  explicit ForcedKernel(const char* name) { setenv("ALIDADE_SIMD", name, 1); }
  ~ForcedKernel() { unsetenv("ALIDADE_SIMD"); }
};

Camera camera(CameraModel model, const std::vector<double>& parameters) {
  return Camera(*Intrinsics::fromParameters(model, 640, 480, parameters));
}

struct NamedCamera {
  const char* name;
  Camera camera;
};

std::vector<NamedCamera> everyLens() {
  const double f = 420, cx = 318.2, cy = 241.7;
  return {
      {"pinhole", camera(CameraModel::Pinhole, {f, f + 3, cx, cy})},
      {"radial", camera(CameraModel::Radial, {f, cx, cy, -0.12, 0.02})},
      {"brown", camera(CameraModel::OpenCv5, {f, f, cx, cy, -0.31, 0.12, 0.001, -0.002, -0.03})},
      {"tilted", camera(CameraModel::OpenCv14, {f, f, cx, cy, 0.1, -0.05, 0.001, -0.001, 0.01, 0.12, -0.02,
                                                0.004, 0.001, -0.0005, 0.0008, 0.0002, 0.01, -0.02})},
      {"fisheye",
       camera(CameraModel::OpenCvFisheye, {f * 0.6, f * 0.6, cx, cy, -0.02, 0.004, -0.001, 0.0002})},
  };
}

const RigidTransform kView = RigidTransform::cameraLookingAt({3, 2, 1.6}, {17, 10, 1.2});

SplatLayer whole(const std::shared_ptr<const PointStore>& store, const Camera& camera,
                 const RigidTransform& pose) {
  return {store, selectAll(*store, camera, pose)};
}

/// Double precision, one point after another, through the camera's own projection.
struct Reference {
  DepthImage depth;
  /// Nearest depth over all that could round into the pixel, and farthest that the winner may have: a
  /// float may put a point that lies on a pixel's border to either side.
  DepthImage depthIfBorderPointsCome, depthIfBorderPointsGo;
};

Reference reference(const PointStore& store, const Camera& camera, const RigidTransform& pose) {
  const float inf = std::numeric_limits<float>::infinity();
  const DepthImage empty(camera.width(), camera.height(), inf);
  Reference picture{empty, empty, empty};
  const auto draw = [&](DepthImage& image, double u, double v, double z) {
    // A point just before the camera's plane lands further out than an int counts.
    if (!(std::abs(u) < 1e6 && std::abs(v) < 1e6)) return;
    const int x = static_cast<int>(std::floor(u + 0.5)), y = static_cast<int>(std::floor(v + 0.5));
    if (image.contains(x, y)) image.at(x, y) = std::min(image.at(x, y), static_cast<float>(z));
  };
  constexpr double kBorder = 2e-3;  // pixels
  for (const CloudNode& node : store.nodes()) {
    for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
      const DisplayPoint& p = store.points()[i];
      const glm::dvec3 inCamera = pose * (node.origin + glm::dvec3(p.x, p.y, p.z) * node.step);
      const auto pixel = camera.project(inCamera);
      const bool maybe = camera.project(inCamera * glm::dvec3(1 - 1e-6, 1 - 1e-6, 1)).has_value();
      if (!maybe) continue;
      const glm::dvec2 at = camera.projectUnchecked(inCamera);
      if (pixel) draw(picture.depth, at.x, at.y, inCamera.z);
      for (const double dx : {-kBorder, kBorder}) {
        for (const double dy : {-kBorder, kBorder}) {
          draw(picture.depthIfBorderPointsCome, at.x + dx, at.y + dy, inCamera.z);
        }
      }
      const glm::dvec2 within = glm::abs(at - glm::floor(at + 0.5));
      // The lens's domain ends with the same float's blur.
      const bool wellInsideFold = camera.project(inCamera * glm::dvec3(1 + 3e-6, 1 + 3e-6, 1)).has_value();
      if (wellInsideFold && std::max(within.x, within.y) < 0.5 - kBorder) {
        draw(picture.depthIfBorderPointsGo, at.x, at.y, inCamera.z);
      }
    }
  }
  return picture;
}

TEST(Splatter, AgreesWithADoublePrecisionReferenceThroughEveryLens) {
  const auto store = storeFrom(unevenRoom(400'000), 5000);
  for (const auto& [name, lens] : everyLens()) {
    const Reference expected = reference(*store, lens, kView);
    const SplatImages drawn = splat({whole(store, lens, kView)}, lens, kView, {.maximumSizePx = 1.0});
    std::size_t covered = 0, exact = 0;
    for (std::size_t i = 0; i < drawn.depth.size(); ++i) {
      const float z = drawn.depth.data()[i];
      const float low = expected.depthIfBorderPointsCome.data()[i],
                  high = expected.depthIfBorderPointsGo.data()[i];
      // Sums of some 20 m in floats: 2 micrometres, and a few roundings of z itself.
      ASSERT_GE(z, low * (1 - 1e-6f) - 2e-6f) << name << " pixel " << i;
      ASSERT_TRUE(z <= high * (1 + 1e-6f) + 2e-6f) << name << " pixel " << i;
      covered += std::isfinite(z);
      exact += std::isfinite(z) && std::abs(z - expected.depth.data()[i]) <= 1e-6f * z + 2e-6f;
    }
    ASSERT_GT(covered, 20'000u) << name;
    EXPECT_GT(exact, 0.99 * covered) << name;
  }
}

void expectSame(const SplatImages& a, const SplatImages& b, const std::string& what) {
  ASSERT_EQ(a.depth.size(), b.depth.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.depth.size(); ++i) {
    different += a.depth.data()[i] != b.depth.data()[i];
    if (!a.colour.empty()) different += !(a.colour.data()[i] == b.colour.data()[i]);
    if (!a.point.empty()) different += a.point.data()[i] != b.point.data()[i];
  }
  EXPECT_EQ(different, 0u) << what;
}

TEST(Splatter, ThreeKernelsGiveOnePicture) {
  const auto store = storeFrom(unevenRoom(150'001), 3000);
  for (const auto& [name, lens] : everyLens()) {
    for (const double size : {0.5, 2.5}) {
      for (const bool ids : {false, true}) {
        const SplatOptions options{.colour = true, .ids = ids, .pointSize = size, .round = ids};
        const std::vector<SplatLayer> layers{whole(store, lens, kView)};
        const SplatImages fastest = splat(layers, lens, kView, options);
        for (const char* kernel : {"avx2", "scalar"}) {
          const ForcedKernel forced(kernel);
          expectSame(fastest, splat(layers, lens, kView, options),
                     std::string(name) + " " + splatKernelName());
        }
      }
    }
  }
  const ForcedKernel forced("scalar");
  EXPECT_STREQ(splatKernelName(), "scalar");
}

TEST(Splatter, TenThousandKilometresAwayIsTheSamePicture) {
  const glm::dvec3 far(1e7, -1e7, 1e3);
  const auto here = storeFrom(unevenRoom(200'000)), there = storeFrom(unevenRoom(200'000, far));
  for (const auto& [name, lens] : everyLens()) {
    const auto farView =
        RigidTransform::cameraLookingAt(glm::dvec3(3, 2, 1.625) + far, glm::dvec3(17, 10, 1.25) + far);
    const auto nearView = RigidTransform::cameraLookingAt({3, 2, 1.625}, {17, 10, 1.25});
    const SplatOptions options{.colour = true, .maximumSizePx = 1.0};
    const SplatImages a = splat({whole(here, lens, nearView)}, lens, nearView, options);
    const SplatImages b = splat({whole(there, lens, farView)}, lens, farView, options);
    // The pose itself is a quaternion and a translation of 10^7 m: its own rounding, some 1e-9 m, moves
    // no more than a few points over a pixel's border.
    std::size_t different = 0, covered = 0;
    for (std::size_t i = 0; i < a.depth.size(); ++i) {
      const float za = a.depth.data()[i], zb = b.depth.data()[i];
      covered += std::isfinite(za);
      different += !(std::abs(za - zb) <= 1e-6f * za) && !(std::isinf(za) && std::isinf(zb));
    }
    ASSERT_GT(covered, 10'000u);
    EXPECT_LE(different, covered / 2000) << name;
  }
}

TEST(Splatter, NothingReturnsFromBeyondTheFoldBackRadius) {
  // k1 = -0.5 folds back at r = sqrt(1/1.5) = 0.816; a point at r = 1.4 would land at r'' = 0.03.
  const Camera barrel = camera(CameraModel::SimpleRadial, {300, 319.5, 239.5, -0.5});
  PointBatch batch;
  batch.position = {{1.4, 0, 1}, {0.1, 0, 2}, {0, 0, -1}, {0, 0, 0}};
  const auto store = storeFrom(batch);
  ASSERT_LT(std::abs(300 * 1.4 * (1 - 0.5 * 1.96)), 20.0);
  const RigidTransform pose;
  const SplatOptions options{.ids = true, .maximumSizePx = 1.0};
  const SplatImages drawn = splat({whole(store, barrel, pose)}, barrel, pose, options);
  std::size_t covered = 0;
  for (std::size_t i = 0; i < drawn.depth.size(); ++i) {
    if (!std::isfinite(drawn.depth.data()[i])) continue;
    ++covered;
    EXPECT_NEAR(drawn.depth.data()[i], 2.0f, 1e-3f);
    EXPECT_EQ(store->sourcePosition(drawn.point.data()[i] - 1), batch.position[1]);
  }
  EXPECT_EQ(covered, 1u);
}

TEST(Splatter, IdsNameTheWinnerOverAllLayers) {
  const auto first = storeFrom(unevenRoom(60'000, {0, 0, 0}, 1)),
             second = storeFrom(unevenRoom(60'000, {0, 0, 0.5}, 2));
  const Camera lens = everyLens()[2].camera;
  const SplatImages drawn = splat({whole(first, lens, kView), whole(second, lens, kView)}, lens, kView,
                                  {.colour = true, .ids = true, .maximumSizePx = 1.0});
  std::size_t fromFirst = 0, fromSecond = 0;
  for (int y = 0; y < drawn.depth.height(); ++y) {
    for (int x = 0; x < drawn.depth.width(); ++x) {
      const std::uint64_t id = drawn.point.at(x, y);
      ASSERT_EQ(id == 0, std::isinf(drawn.depth.at(x, y)));
      ASSERT_EQ(id == 0, drawn.colour.at(x, y).a == 0);
      if (id == 0) continue;
      const bool isFirst = id <= first->pointCount();
      (isFirst ? fromFirst : fromSecond) += 1;
      const PointStore& store = isFirst ? *first : *second;
      const std::uint64_t index = id - 1 - (isFirst ? 0 : first->pointCount());
      const glm::dvec3 inCamera = kView * store.sourcePosition(index);
      const glm::dvec2 pixel = lens.projectUnchecked(inCamera);
      // A source point is up to half a step, 0.24 mm, from what was drawn of it.
      EXPECT_NEAR(drawn.depth.at(x, y), inCamera.z, 1e-3);
      EXPECT_LT(glm::length(pixel - glm::dvec2(x, y)), 0.75 + 420 * 0.5e-3 / inCamera.z);
      const glm::u8vec3 rgb = *store.sourceColour(index);
      EXPECT_NEAR(drawn.colour.at(x, y).r, rgb.r, 8);
      EXPECT_NEAR(drawn.colour.at(x, y).g, rgb.g, 4);
      EXPECT_NEAR(drawn.colour.at(x, y).b, rgb.b, 8);
    }
  }
  EXPECT_GT(fromFirst, 1000u);
  EXPECT_GT(fromSecond, 1000u);
}

/// One point in the middle of a 101 x 101 picture, f = 100, z = 2 m, spacing told to the splatter.
SplatImages onePoint(SplatOptions options, double spacing) {
  options.surface = false;
  PointBatch batch;
  batch.position = {{0, 0, 2}};
  const Camera lens = pinhole(101, 101, 100);
  SplatLayer layer = whole(storeFrom(batch), lens, {});
  layer.selection.ranges.at(0).spacing = spacing;
  return splat({layer}, lens, {}, options);
}

int coveredWidth(const SplatImages& images, int row) {
  int covered = 0;
  for (int x = 0; x < images.depth.width(); ++x) covered += std::isfinite(images.depth.at(x, row));
  return covered;
}

TEST(Splatter, FootprintsFollowSpacingOverDepth) {
  // 0.1 m at 2 m is s = 5 pixels, the footprint 1.5 s - 0.5 = 7.
  EXPECT_EQ(coveredWidth(onePoint({}, 0.1), 50), 7);
  EXPECT_EQ(coveredWidth(onePoint({.pointSize = 2.0}, 0.1), 50), 15);  // 14.5: centres at -7..7
  EXPECT_EQ(coveredWidth(onePoint({}, 0.02), 50), 1);
  EXPECT_EQ(coveredWidth(onePoint({}, 0.001), 50), 1);
  EXPECT_EQ(coveredWidth(onePoint({.maximumSizePx = 3}, 0.1), 50), 3);
  EXPECT_EQ(coveredWidth(onePoint({.minimumSizePx = 4}, 0.001), 50), 4);
  EXPECT_EQ(coveredWidth(onePoint({.pointSize = 3, .fixedSize = true}, 0.1), 50), 3);
  // A's width in the world is taken as it is.
  EXPECT_EQ(coveredWidth(onePoint({.worldSizeM = 0.1}, 0.001), 50), 5);
  EXPECT_EQ(coveredWidth(onePoint({.pointSize = 2.0, .worldSizeM = 0.1}, 0.3), 50), 10);
  const SplatImages disc = onePoint({.round = true}, 0.38 / 3);  // 9 pixels
  EXPECT_EQ(coveredWidth(disc, 50), 9);
  EXPECT_EQ(coveredWidth(disc, 46), 5);  // 2 sqrt(4.5² - 4²) = 4.1: centres at -2..2
}

TEST(Splatter, AFootprintWithoutAPlaneBendsAwayFromTheEye) {
  // 7 pixels of 1/100: half its width is 0.035 of its depth, of which it bends two fifths away at its border.
  const SplatImages dome = onePoint({}, 0.1), square = onePoint({.planar = false}, 0.1);
  EXPECT_NEAR(dome.depth.at(50, 50), 2.0f, 5e-4f);
  for (const int x : {47, 53}) {
    EXPECT_NEAR(dome.depth.at(x, 50), 2.0 * (1 + 0.4 * 0.035 * std::pow(3 / 3.5, 2)), 5e-4);
    EXPECT_NEAR(square.depth.at(x, 50), 2.0f, 5e-4f);
  }
}

TEST(Splatter, FootprintsAreCutAtThePicturesBorder) {
  PointBatch batch;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> side(-3.0, 3.0);
  for (int i = 0; i < 5000; ++i)
    batch.position.push_back({side(random), side(random), 2.0 + 0.1 * side(random)});
  const Camera lens = pinhole(97, 61, 50);
  const auto store = storeFrom(batch);
  for (const bool round : {false, true}) {
    const SplatImages drawn = splat({whole(store, lens, {})}, lens, {}, {.pointSize = 40, .round = round});
    for (std::size_t i = 0; i < drawn.depth.size(); ++i) ASSERT_LT(drawn.depth.data()[i], 2.4f);
  }
}

TEST(Splatter, ABrokenPoseOrNoPointsGiveAnEmptyPicture) {
  const auto store = storeFrom(unevenRoom(1000));
  const Camera lens = pinhole(64, 48, 50);
  RigidTransform broken = kView;
  broken.translation.x = std::nan("");
  const SplatLayer layer{store, selectAll(*store, lens, kView)};
  for (const SplatImages& drawn : {splat({layer}, lens, broken, {.colour = true, .ids = true}),
                                   splat({}, lens, kView, {.colour = true, .ids = true}),
                                   splat({SplatLayer{}}, lens, kView, {.colour = true, .ids = true})}) {
    for (std::size_t i = 0; i < drawn.depth.size(); ++i) {
      ASSERT_TRUE(std::isinf(drawn.depth.data()[i]));
      ASSERT_EQ(drawn.point.data()[i], 0u);
    }
  }
}

}  // namespace
}  // namespace alidade
