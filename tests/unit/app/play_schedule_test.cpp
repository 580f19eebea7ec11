// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/play_schedule.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace alidade {

namespace {

std::vector<double> atRate(int frames, double rate) {
  std::vector<double> secs;
  for (int i = 0; i < frames; ++i) secs.push_back(100 + i / rate);
  return secs;
}

struct Shown {
  int frame;
  double at;
};

/// Plays on a clock of its own: one frame is drawn at a time, each taking what `drawSecs` says.
template <class DrawSecs>
std::vector<Shown> play(PlaySchedule& schedule, const std::vector<double>& secs, double speed, const DrawSecs& drawSecs) {
  std::vector<Shown> shown;
  std::deque<int> drawn;
  double now = 5;
  schedule.begin(secs, -1, speed, now);
  for (int guard = 0; !schedule.finished() && guard < 100000; ++guard) {
    while (schedule.takeDue(now)) {
      shown.push_back({drawn.front(), now});
      drawn.pop_front();
    }
    const auto order = schedule.order(now);
    if (!order) {
      now = std::max(now, schedule.nextDue().value_or(now));
      continue;
    }
    // What falls due meanwhile is shown on time: another thread draws.
    const double end = now + drawSecs(order->frame);
    while (schedule.nextDue() && *schedule.nextDue() <= end) {
      now = std::max(now, *schedule.nextDue());
      if (schedule.takeDue(now)) {
        shown.push_back({drawn.front(), now});
        drawn.pop_front();
      }
    }
    now = end;
    schedule.drawn();
    drawn.push_back(order->frame);
  }
  return shown;
}

}  // namespace

TEST(PlaySchedule, FramesThatAreDrawnInTimeAreAllShownWhenTheyAreDue) {
  PlaySchedule schedule;
  const auto secs = atRate(60, 15);
  // On average well within 66 ms; one in ten takes 100 ms, which the frame drawn ahead hides.
  const auto shown = play(schedule, secs, 1, [](int frame) { return frame % 10 == 7 ? 0.1 : 0.05; });
  EXPECT_EQ(schedule.dropped(), 0);
  ASSERT_EQ(shown.size(), 60u);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    EXPECT_EQ(shown[i].frame, static_cast<int>(i));
    EXPECT_NEAR(shown[i].at - shown[0].at, static_cast<double>(i) / 15, 2e-3);
  }
}

TEST(PlaySchedule, ASlowMachineLeavesFramesOutButKeepsTheTime) {
  PlaySchedule schedule;
  const auto secs = atRate(150, 15);
  const auto shown = play(schedule, secs, 1, [](int) { return 0.15; });
  EXPECT_EQ(schedule.dropped() + static_cast<int>(shown.size()), 150) << "every frame is shown or counted";
  EXPECT_NEAR(static_cast<double>(shown.size()), 10 / 0.15, 5);
  for (const Shown& each : shown) {
    const double late = (each.at - shown[0].at) - (secs[static_cast<std::size_t>(each.frame)] - secs[static_cast<std::size_t>(shown[0].frame)]);
    EXPECT_LT(std::abs(late), 0.35) << each.frame;
  }
  EXPECT_EQ(shown.back().frame, 149) << "the last frame is always shown";
}

TEST(PlaySchedule, SpeedAndUnevenTimesAreKept) {
  PlaySchedule schedule;
  const std::vector<double> secs = {0, 0.02, 0.1, 0.13, 300, 300.05};
  const auto shown = play(schedule, secs, 0.5, [](int) { return 0.01; });
  ASSERT_EQ(shown.size(), 6u);
  const double expected[] = {0, 0.04, 0.2, 0.26, 2.26, 2.36};  // 5 minutes are held to a second
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(shown[i].at - shown[0].at, expected[i], 2e-3) << i;
}

TEST(PlaySchedule, NothingToPlayIsFinishedAtOnce) {
  PlaySchedule schedule;
  EXPECT_TRUE(schedule.finished());
  schedule.begin({}, -1, 1, 0);
  EXPECT_TRUE(schedule.finished());
  EXPECT_FALSE(schedule.order(0));
  schedule.begin({1, 2, 3}, 2, 1, 0);
  EXPECT_TRUE(schedule.finished()) << "after the last frame there is none";
  EXPECT_FALSE(schedule.takeDue(10));
}

}  // namespace alidade
