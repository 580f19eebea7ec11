// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/play_quality.h"

#include <gtest/gtest.h>

namespace alidade {

TEST(PlayQuality, ASlowFrameNowAndThenChangesNothing) {
  PlayQuality quality;
  for (int i = 0; i < 200; ++i) quality.drawn(i % 3 == 0 ? 300 : 50, 66);
  EXPECT_EQ(quality.shrink(), 1);
}

TEST(PlayQuality, FramesThatDoNotKeepUpAreDrawnSmallerUntilTheyWouldAgain) {
  PlayQuality quality;
  for (int i = 0; i < 6; ++i) quality.drawn(90, 66);
  EXPECT_EQ(quality.shrink(), 2);
  // At half the size it keeps up, but at full size it would not.
  for (int i = 0; i < 200; ++i) quality.drawn(30, 66);
  EXPECT_EQ(quality.shrink(), 2);
  for (int i = 0; i < 200; ++i) quality.drawn(10, 66);
  EXPECT_EQ(quality.shrink(), 1);
}

TEST(PlayQuality, TheStepCountsNotTheTime) {
  PlayQuality quality;
  for (int i = 0; i < 50; ++i) quality.drawn(90, 133);  // half speed
  EXPECT_EQ(quality.shrink(), 1);
}

}  // namespace alidade
