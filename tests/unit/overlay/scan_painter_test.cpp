// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/scan_painter.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace alidade {

namespace {

/// A wall of 8 m × 6 m in the plane y = 0, half of it class 2, half class 6.
std::shared_ptr<const PointStore> wall(std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(-4, 4), up(-3, 3);
  PointBatch batch;
  for (std::size_t i = 0; i < count; ++i) {
    batch.position.push_back({along(random), 0, up(random)});
    batch.rgb.push_back({200, 100, 50});
    batch.classification.push_back(batch.position.back().x < 0 ? 2 : 6);
  }
  PointStoreBuilder builder;
  builder.add(batch);
  return *builder.build(Progress());
}

struct Wall : ::testing::Test {
  Wall() {
    frame.camera = Camera(*Intrinsics::fromParameters(CameraModel::Pinhole, 320, 240, {200, 200, 159.5, 119.5}));
    lookFrom({0, -8, 0});
    frame.scans.push_back({{store, nullptr, 0}, nullptr});
    frame.display.pointPass = true;
  }
  void lookFrom(const glm::dvec3& eye) { frame.cameraFromWorld = RigidTransform::cameraLookingAt(eye, eye + glm::dvec3(0, 8, 0)); }
  ScanPictures draw() { return painter.draw(frame, frame.camera); }

  std::shared_ptr<const PointStore> store = wall(200'000);
  FrameDescription frame;
  double now = 0;
  ScanPainter painter{[this] { return now; }};
};

std::size_t known(const DepthImage& depth) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) count += std::isfinite(depth.data()[i]);
  return count;
}

}  // namespace

TEST_F(Wall, PointByPointDrawsFewerAndStillWhatTheClassesLeave) {
  lookFrom({-3.9, -1.5, 0});
  const ScanPictures nodes = draw();
  frame.display.levelThreshold = LevelThreshold::ByPoint;
  const ScanPictures points = draw();
  EXPECT_EQ(points.chosen, nodes.chosen);
  EXPECT_LT(points.drawn, nodes.drawn);
  EXPECT_EQ(known(points.depth), known(nodes.depth));
  frame.display.points.hiddenClasses.set(6);
  const ScanPictures near = draw();
  frame.display.points.hiddenClasses.reset();
  frame.display.points.hiddenClasses.set(2);
  EXPECT_EQ(near.drawn + draw().drawn, points.drawn);
}

TEST_F(Wall, CountsAsDrawnWhatTheClassesLeave) {
  const ScanPictures all = draw();
  EXPECT_EQ(all.total, 200'000u);
  EXPECT_EQ(all.drawn, all.chosen);
  frame.display.points.hiddenClasses.set(6);
  const ScanPictures half = draw();
  EXPECT_EQ(half.chosen, all.chosen);
  EXPECT_NEAR(static_cast<double>(half.drawn), 0.5 * static_cast<double>(all.drawn), 0.02 * static_cast<double>(all.drawn));
  frame.display.pointPass = false;
  EXPECT_EQ(draw().drawn, half.drawn);
  frame.display.points.hiddenClasses.set(2);
  EXPECT_EQ(draw().drawn, 0u);
}

TEST_F(Wall, ASampleCountsAsTheWholeItStandsFor) {
  frame.scans[0].sampleOf = 10'000'000;
  EXPECT_EQ(draw().total, 10'000'000u);
}

TEST_F(Wall, ABudgetHoldsForWhatIsShownAndForWhatJudges) {
  const ScanPictures all = draw();
  frame.pointBudget = 10'000;
  const ScanPictures few = draw();
  EXPECT_LE(few.chosen, 10'000u);
  EXPECT_LE(few.judged, 10'000u);
  EXPECT_GT(few.judged, 5'000u);
  EXPECT_GT(all.judged, 100'000u);
  // Thinned evenly: nearly all of the wall still hides.
  EXPECT_GT(known(few.depth), known(all.depth) * 9 / 10);
}

TEST_F(Wall, APlayedFrameIsJudgedOnHalfItsSizeAndFullSizeComesOfIt) {
  lookFrom({1, -8, 0.5});
  const DepthImage still = draw().depth;
  frame.playing = true;
  const DepthImage played = draw().depth;
  ASSERT_EQ(played.width(), still.width());
  ASSERT_EQ(played.height(), still.height());
  EXPECT_GT(known(played), known(still) * 19 / 20);
  for (int y = 60; y < 180; ++y)
    for (int x = 80; x < 220; ++x) EXPECT_NEAR(played.at(x, y), 8.0, 0.01) << x << ' ' << y;
}

/// Closed form: the ray of a pixel from the pose of its row meets the plane y = 0.
TEST_F(Wall, ARollingShutterSeesTheDepthOfEachRowsPose) {
  lookFrom({0.3, -8, 0.2});
  frame.shutter.readoutSecs = 0.04;
  frame.shutter.motion = {{0.2, -0.6, 0.4}, {1.0, 0.5, 2.0}};
  const ScanPictures seen = draw();
  frame.shutter = {};
  const ScanPictures unmoved = draw();
  frame.shutter.readoutSecs = 0.04;
  frame.shutter.motion = {{0.2, -0.6, 0.4}, {1.0, 0.5, 2.0}};
  double worst = 0, worstUnmoved = 0;
  for (int y = 70; y < 170; ++y) {
    const RigidTransform worldFromRow = frame.shutter.poseAtRow(frame.cameraFromWorld, y, 240).inverse();
    for (int x = 90; x < 210; ++x) {
      const glm::dvec3 ray = worldFromRow.rotationMatrix() * *frame.camera.unproject({x, y});
      const double depth = -worldFromRow.translation.y / ray.y;
      ASSERT_TRUE(std::isfinite(seen.depth.at(x, y))) << x << ' ' << y;
      worst = std::max(worst, std::abs(seen.depth.at(x, y) - depth));
      worstUnmoved = std::max(worstUnmoved, std::abs(unmoved.depth.at(x, y) - depth));
    }
  }
  EXPECT_LT(worst, 0.005);
  EXPECT_GT(worstUnmoved, 0.02);
}

/// The two classes part at x = 0, where rows see the border at places of their own.
TEST_F(Wall, ShownPointsStandWhereTheirRowSeesThem) {
  frame.display.points.hiddenClasses.set(6);
  frame.shutter.readoutSecs = 0.04;
  frame.shutter.motion = {{0, -0.8, 0}, {1.0, 0, 0}};
  const ScanPictures seen = draw();
  for (const int y : {70, 100, 140, 170}) {
    const auto border = project(frame.camera, frame.shutter, frame.cameraFromWorld * glm::dvec3(0, 0, (119.5 - y) / 200 * 8));
    ASSERT_TRUE(border);
    int last = 0;
    for (int x = 0; x < 320; ++x)
      if (seen.colour.at(x, y).a > 0) last = x;
    EXPECT_NEAR(last, border->x, 2.0) << y;
  }
}

TEST_F(Wall, PointsChosenForOneFrameServeOthersForAWhile) {
  frame.selectionAgeMs = 100;
  const std::uint64_t near = draw().chosen;
  lookFrom({0, -30, 0});
  now = 99;
  EXPECT_EQ(draw().chosen, near);
  now = 101;
  const std::uint64_t far = draw().chosen;
  EXPECT_LT(far, near / 2);
  lookFrom({0, -8, 0});
  frame.selectionAgeMs = 0;  // still again
  EXPECT_EQ(draw().chosen, near);
}

}  // namespace alidade
