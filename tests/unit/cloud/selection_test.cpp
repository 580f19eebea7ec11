// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/selection.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

using test::pinhole;
using test::storeFrom;
using test::unevenRoom;

const RigidTransform kView = RigidTransform::cameraLookingAt({-4, -3, 2}, {12, 8, 1});

std::map<std::uint32_t, std::uint32_t> prefixes(const Selection& selection) {
  std::map<std::uint32_t, std::uint32_t> counts;
  for (const SelectedRange& range : selection.ranges) counts[range.node] = range.count;
  return counts;
}

/// What was drawn stays drawn, and no step of 1/1000 changes more than 0.5 % of all.
void expectSmoothSlider(const PointStore& store, const Camera& camera, const RigidTransform& pose,
                        SelectionOptions options) {
  options.density = 1.0;
  const std::uint64_t total = select(store, camera, pose, options).pointCount;
  ASSERT_GT(total, 0u);
  std::map<std::uint32_t, std::uint32_t> before;
  std::uint64_t countBefore = 0;
  for (int step = 0; step <= 1000; ++step) {
    options.density = step / 1000.0;
    const Selection selection = select(store, camera, pose, options);
    const auto counts = prefixes(selection);
    for (const auto& [node, count] : before) {
      const auto now = counts.find(node);
      ASSERT_TRUE(now != counts.end() && now->second >= count) << "node " << node << " at step " << step;
    }
    ASSERT_LE(selection.pointCount - countBefore, static_cast<std::uint64_t>(std::ceil(0.005 * total)))
        << step;
    before = counts;
    countBefore = selection.pointCount;
  }
  EXPECT_EQ(countBefore, total);
}

TEST(Selection, GrowsSmoothlyWithTheSlider) {
  const auto store = storeFrom(unevenRoom(300'000), 5000);
  const Camera camera = pinhole(960, 540, 700);
  for (const DensityLaw law : {DensityLaw::PointsPerPixel, DensityLaw::PointsPerSquareMetre}) {
    for (const std::uint64_t budget : {0, 40'000}) {
      SelectionOptions options;
      options.law = law;
      options.pointsPerSquareMetre = 3000;
      options.pointBudget = budget;
      if (budget == 0) expectSmoothSlider(*store, camera, kView, options);
      const Selection selection = select(*store, camera, kView, options);
      if (budget > 0) {
        EXPECT_LE(selection.pointCount, budget);
        EXPECT_GT(selection.pointCount, budget * 9 / 10);
      }
    }
  }
}

TEST(Selection, ABudgetStopsTheSliderButNeverTakesPointsAway) {
  const auto store = storeFrom(unevenRoom(300'000), 5000);
  SelectionOptions options;
  options.pointBudget = 30'000;
  std::uint64_t before = 0;
  for (int step = 0; step <= 100; ++step) {
    options.density = step / 100.0;
    const std::uint64_t count = select(*store, pinhole(960, 540, 700), kView, options).pointCount;
    EXPECT_GE(count, before);
    EXPECT_LE(count, options.pointBudget);
    before = count;
  }
}

TEST(Selection, GrowsSmoothlyOnARealRoom) {
  const PointBatch batch =
      test::lasPositions(std::string(ALIDADE_SHARED_DATA_DIR) + "/indoor_video/cloud_quarter.las");
  if (batch.size() == 0) GTEST_SKIP() << "no indoor_video/cloud_quarter.las in " << ALIDADE_SHARED_DATA_DIR;
  const auto store = storeFrom(batch);
  const glm::dvec3 middle = store->bounds().centre();
  const auto pose = RigidTransform::cameraLookingAt(middle, store->bounds().max);
  expectSmoothSlider(*store, pinhole(540, 360, 430), pose, {});
}

TEST(Selection, DensityZeroDrawsNothingAndOneTheWantedDensity) {
  const auto store = storeFrom(unevenRoom(300'000), 5000);
  SelectionOptions options;
  options.density = 0;
  EXPECT_EQ(select(*store, pinhole(960, 540, 700), kView, options).pointCount, 0u);
  options.density = 1;
  // A fine enough picture wants every point that it sees.
  const Camera large = pinhole(9600, 5400, 7000);
  options.targetSpacingPx = 1e-4;
  EXPECT_EQ(select(*store, large, kView, options).pointCount, selectAll(*store, large, kView).pointCount);
  options.density = std::nan("");
  EXPECT_EQ(select(*store, large, kView, options).pointCount, 0u);
}

TEST(Selection, ReachesTheWantedSpacingOnScreen) {
  // A wall 10 m away, points 2 mm apart: 0.14 px at f = 700; wanted is a pixel, so 1 in 51 is drawn.
  PointBatch batch;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  for (int i = 0; i < 1'000'000; ++i) batch.position.push_back({side(random), 10.0, side(random)});
  const auto store = storeFrom(batch);
  const Camera camera = pinhole(400, 400, 700);
  const Selection selection =
      select(*store, camera, RigidTransform::cameraLookingAt({0, 0, 0}, {0, 10, 0}), {});
  const double pixels = 140.0 * 140.0;
  EXPECT_NEAR(static_cast<double>(selection.pointCount) / pixels, 1.0, 0.15);
  for (const SelectedRange& range : selection.ranges) {
    if (range.count > 500) {
      EXPECT_NEAR(range.spacing * 70, 1.0, 0.15);
    }
  }
}

TEST(Selection, ASurfaceSeenAtAnAngleGetsAsManyPointsAPixel) {
  // A wall 10 m away, points 2 mm apart, turned by some degrees about the vertical.
  for (const double degrees : {30.0, 45.0, 60.0}) {
    const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
    PointBatch batch;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> side(-1.0, 1.0);
    for (int i = 0; i < 1'000'000; ++i) {
      const double along = side(random);
      batch.position.push_back({along * c, 10.0 + along * s, side(random)});
    }
    const auto store = storeFrom(batch);
    const Camera camera = pinhole(400, 400, 700);
    const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 10, 0});
    const double pixels = 140.0 * 140.0 * c;
    const auto perPixel = [&](const SelectionOptions& options) { return static_cast<double>(select(*store, camera, pose, options).pointCount) / pixels; };
    // By the nearest of each node and with what its roughness may show: rather more than too few.
    EXPECT_GT(perPixel({}), 0.9) << degrees;
    EXPECT_LT(perPixel({}), 1.5) << degrees;
    EXPECT_NEAR(perPixel({.byFacing = false}) * c, 1.0, 0.2) << degrees;
    SelectionOptions byPoint{.threshold = LevelThreshold::ByPoint};
    EXPECT_NEAR(perPixel(byPoint) * c, 1.0, 0.2) << degrees;
  }
}

TEST(Selection, FollowsTheLawOfZhang) {
  PointBatch batch;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  for (int i = 0; i < 1'000'000; ++i) batch.position.push_back({side(random), 10.0, side(random)});
  SelectionOptions options;
  options.law = DensityLaw::PointsPerSquareMetre;
  options.pointsPerSquareMetre = 100'000;
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 10, 0});
  const Selection selection = select(*storeFrom(batch), pinhole(400, 400, 700), pose, options);
  // Blue noise: how many points a spacing stands for is known to some tenth between two octaves.
  EXPECT_NEAR(selection.pointCount / 4.0, 100'000 / std::log(11.0), 0.15 * 100'000 / std::log(11.0));
}

/// Strong barrel distortion: what a pinhole of the same focal length would miss is seen, and what the
/// selection leaves out no pixel can show.
TEST(Selection, LosesNothingThatTheDistortedLensSees) {
  const auto store = storeFrom(unevenRoom(200'000), 500);
  const Camera barrel(*Intrinsics::fromParameters(
      CameraModel::OpenCv5, 640, 480, {300, 300, 319.5, 239.5, -0.25, 0.05, 0.001, -0.001, -0.004}));
  const Camera fisheye(*Intrinsics::fromParameters(CameraModel::OpenCvFisheye, 640, 480,
                                                   {250, 250, 319.5, 239.5, -0.01, 0.003, 0, 0}));
  for (const Camera& camera : {barrel, fisheye, pinhole(640, 480, 500)}) {
    for (const glm::dvec3 eye : {glm::dvec3(10, 6, 1.5), glm::dvec3(-30, -20, 15), glm::dvec3(19, 11, 0.5)}) {
      for (const glm::dvec3 target : {glm::dvec3(20, 12, 1), glm::dvec3(0, 0, 0), glm::dvec3(12, -8, 0)}) {
        const auto pose = RigidTransform::cameraLookingAt(eye, target);
        const auto chosen = prefixes(selectAll(*store, camera, pose));
        for (std::uint32_t n = 0; n < store->nodes().size(); ++n) {
          const CloudNode& node = store->nodes()[n];
          if (chosen.contains(n)) continue;
          for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
            const auto pixel = camera.project(pose * store->sourcePosition(i));
            ASSERT_FALSE(pixel && camera.inPicture(*pixel));
          }
        }
      }
    }
  }
}

TEST(Selection, CullsWhatLiesOutsideTheFieldOfView) {
  const auto store = storeFrom(unevenRoom(200'000), 500);
  const Camera camera = pinhole(640, 480, 2000);
  const auto pose = RigidTransform::cameraLookingAt({10, 6, 1.5}, {20, 6, 1});
  const std::uint64_t selected = selectAll(*store, camera, pose).pointCount;
  std::uint64_t seen = 0;
  for (std::uint64_t i = 0; i < store->pointCount(); ++i) {
    const auto pixel = camera.project(pose * store->sourcePosition(i));
    seen += pixel && camera.inPicture(*pixel);
  }
  ASSERT_GT(seen, 1000u);
  EXPECT_LT(selected, 4 * seen);
  const auto away = RigidTransform::cameraLookingAt({-10, -6, 1.5}, {-20, -16, 1});
  EXPECT_EQ(selectAll(*store, camera, away).pointCount, 0u);
}

/// A floor under a camera that looks along it: by the farther and the nearer side of each node's border across the
/// view, the largest difference of the points drawn in half a metre, as a share of both.
double largestJump(const PointStore& store, const SelectionOptions& options) {
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 2}, {20, 0, 0});
  const Selection selection = select(store, pinhole(1200, 800, 120), pose, options);
  std::vector<double> drawn;
  for (const SelectedRange& range : selection.ranges) {
    const CloudNode& node = store.nodes()[range.node];
    const DisplayPoint* points = range.styled != nullptr ? range.styled : store.points().data() + range.first;
    for (std::uint32_t i = 0; i < range.count; ++i) drawn.push_back(node.origin.x + node.step * points[i].x);
  }
  std::sort(drawn.begin(), drawn.end());
  const auto between = [&](double from, double to) {
    return static_cast<double>(std::lower_bound(drawn.begin(), drawn.end(), to) - std::lower_bound(drawn.begin(), drawn.end(), from));
  };
  double most = 0;
  for (const CloudNode& node : store.nodes()) {
    if (node.childCount > 0 || node.bounds.min.x < 4 || node.bounds.min.x > 30) continue;
    const double at = node.bounds.min.x, nearer = between(at - 0.5, at), farther = between(at, at + 0.5);
    if (nearer + farther > 800) most = std::max(most, std::abs(nearer - farther) / (nearer + farther));
  }
  return most;
}

TEST(Selection, ByPointTheDensitiesOfNeighbouringNodesMeetAtTheirBorder) {
  PointBatch batch;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(2, 34), across(-8, 8);
  for (int i = 0; i < 800'000; ++i) batch.position.push_back({along(random), across(random), 0.0});
  const auto store = storeFrom(batch, 2000);
  SelectionOptions options;
  options.threshold = LevelThreshold::ByPoint;
  // The law itself changes by a tenth in half a metre.
  const double byPoint = largestJump(*store, options);
  EXPECT_LT(byPoint, 0.15);
  options.threshold = LevelThreshold::ByDistance;
  EXPECT_GT(largestJump(*store, options), byPoint + 0.1);
}

TEST(Selection, ByPointDrawsWhatTheNodesPrefixesHoldAndNoMore) {
  const auto store = storeFrom(unevenRoom(300'000), 5000);
  const Camera camera = pinhole(960, 540, 700);
  SelectionOptions options, byPoint;
  options.byFacing = false;
  byPoint.threshold = LevelThreshold::ByPoint;
  std::uint64_t before = 0;
  for (const double density : {0.1, 0.3, 0.6, 1.0}) {
    options.density = byPoint.density = density;
    const Selection prefixes = select(*store, camera, kView, options), cut = select(*store, camera, kView, byPoint);
    EXPECT_LT(cut.pointCount, prefixes.pointCount);
    EXPECT_GT(cut.pointCount, std::max(before, prefixes.pointCount / 4));
    before = cut.pointCount;
  }
}

TEST(Selection, AnEmptyStoreSelectsNothing) {
  PointStoreBuilder builder;
  EXPECT_TRUE(select(**builder.build(Progress()), pinhole(640, 480, 500), kView, {}).ranges.empty());
}

}  // namespace
}  // namespace alidade
