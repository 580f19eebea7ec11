// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/frame_pacer.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace alidade {

namespace {

/// A renderer on a clock of its own: a frame costs a fixed time and so much a million points.
struct Renderer {
  double now = 1000, fixedMs = 10, msPerMillion = 50;
  std::uint64_t inView = 8'000'000;
  FramePacer pacer{[this] { return now; }};

  /// The time that the frame took.
  double frame(double wantedMs, std::uint64_t most = 0) {
    const std::uint64_t budget = wantedMs > 0 || most > 0 ? pacer.begin(FramePace{wantedMs, most}) : pacer.begin({});
    used = budget > 0 ? std::min(budget, inView) : inView;
    const double ms = fixedMs + msPerMillion * static_cast<double>(used) / 1e6;
    now += ms;
    pacer.end(used);
    return ms;
  }
  std::uint64_t used = 0;
};

}  // namespace

TEST(FramePacer, HoldsTheWantedTimeWhileMovingAndUsesAllWhenStill) {
  Renderer renderer;
  EXPECT_DOUBLE_EQ(renderer.frame(0), 410);
  double ms = 0;
  for (int i = 0; i < 12; ++i) ms = renderer.frame(40);
  for (int i = 0; i < 20; ++i) {
    ms = renderer.frame(40);
    EXPECT_LE(ms, 40 * 1.05);
    EXPECT_GE(ms, 40 * 0.75);
  }
  renderer.frame(0);
  EXPECT_EQ(renderer.used, renderer.inView);
  // The next movement begins where the last one ended.
  EXPECT_LE(renderer.frame(40), 40 * 1.05);
}

TEST(FramePacer, TheFirstFrameThatMovesIsAlreadyThinned) {
  Renderer renderer;
  renderer.frame(0);
  EXPECT_LT(renderer.frame(40), 100);
}

TEST(FramePacer, FollowsAViewThatBecomesDearerOrCheaper) {
  Renderer renderer;
  for (int i = 0; i < 20; ++i) renderer.frame(40);
  renderer.msPerMillion = 200;
  for (int i = 0; i < 6; ++i) renderer.frame(40);
  EXPECT_LE(renderer.frame(40), 42);
  renderer.msPerMillion = 20;
  for (int i = 0; i < 20; ++i) renderer.frame(40);
  EXPECT_GE(renderer.frame(40), 30);
}

TEST(FramePacer, LeavesAQuickViewAloneAndNeverThinsToNothing) {
  Renderer quick;
  quick.inView = 200'000;
  for (int i = 0; i < 5; ++i) quick.frame(40);
  EXPECT_EQ(quick.used, quick.inView);
  Renderer slow;
  slow.fixedMs = 100;  // no number of points reaches 40 ms
  for (int i = 0; i < 30; ++i) slow.frame(40);
  EXPECT_EQ(slow.used, FramePacer::kFewest);
}

TEST(FramePacer, AViewWithFewerPointsThanTheBudgetDoesNotRaiseIt) {
  Renderer renderer;
  for (int i = 0; i < 20; ++i) renderer.frame(40);
  const std::uint64_t before = renderer.used;
  renderer.inView = 100'000;
  for (int i = 0; i < 20; ++i) renderer.frame(40);
  renderer.inView = 8'000'000;
  renderer.frame(40);
  EXPECT_LE(renderer.used, before * 5 / 4);
}

TEST(FramePacer, ABudgetOfPointsHoldsBesideTheTime) {
  Renderer renderer;
  renderer.frame(0, 300'000);  // no time is asked for
  EXPECT_EQ(renderer.used, 300'000u);
  for (int i = 0; i < 20; ++i) renderer.frame(40, 300'000);
  EXPECT_EQ(renderer.used, 300'000u);  // 25 ms would allow more
  for (int i = 0; i < 20; ++i) renderer.frame(20, 300'000);
  EXPECT_LE(renderer.used, 200'000u);  // the time allows fewer
  renderer.frame(0);
  EXPECT_EQ(renderer.used, renderer.inView);
}

}  // namespace alidade
