// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/patch_matching.h"

#include <cmath>

#include <gtest/gtest.h>

namespace alidade {

namespace {

/// Smooth in both directions, no two places alike; moved by a part of a pixel in closed form.
Image<float> pattern(double dx, double dy, double gain = 1, double offset = 0) {
  Image<float> image(96, 96);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) {
      const double u = x - dx, v = y - dy;
      const double light = 128 + 40 * std::sin(0.31 * u + 0.011 * u * v) + 35 * std::sin(0.37 * v - 0.007 * u * u);
      image.at(x, y) = static_cast<float>(gain * light + offset);
    }
  return image;
}

Image<float> edge(double at) {
  Image<float> image(96, 96);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) image.at(x, y) = static_cast<float>(128 + 80 * std::tanh((x - at) / 2));
  return image;
}

const Image<std::uint8_t> kCovered(96, 96, 1);

}  // namespace

TEST(PatchMatching, FindsAShiftToAHundredthsOfAPixelUnderAnotherExposure) {
  const auto patches = choosePatches(pattern(0, 0), kCovered, 8, 24);
  ASSERT_GE(patches.size(), 9u);
  const Image<float> photo = pattern(2.37, -1.62, 0.6, 30);
  int found = 0;
  for (const Patch& patch : patches) {
    if (patch.at.x < 20 || patch.at.y < 20 || patch.at.x > 75 || patch.at.y > 75) continue;  // its place may lie outside
    const auto place = findPatch(patch, photo, 5, 0.8);
    if (!place) continue;  // as good a place beside it
    ++found;
    EXPECT_NEAR(place->pixel.x, patch.at.x + 2.37, 0.03);
    EXPECT_NEAR(place->pixel.y, patch.at.y - 1.62, 0.03);
    EXPECT_GT(place->correlation, 0.99);
  }
  EXPECT_GE(found, 3);
}

TEST(PatchMatching, APlainPictureHoldsNoPatch) {
  EXPECT_TRUE(choosePatches(Image<float>(96, 96, 90.0f), kCovered, 8, 24).empty());
  EXPECT_TRUE(choosePatches(pattern(0, 0), Image<std::uint8_t>(96, 96, 0), 8, 24).empty());
}

TEST(PatchMatching, WhatIsNotThereIsNotFound) {
  const auto patches = choosePatches(pattern(0, 0), kCovered, 8, 24);
  for (const Patch& patch : patches) EXPECT_FALSE(findPatch(patch, Image<float>(96, 96, 90.0f), 5, 0.6));
}

TEST(PatchMatching, AStraightEdgeCountsAcrossAlone) {
  const auto patches = choosePatches(edge(48), kCovered, 8, 96);
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_FALSE(findPatch(patches[0], edge(49.4), 4, 0.6)) << "one place along the edge is as good as the next";
  const auto place = followPatch(patches[0], edge(49.4), 4, 0.6);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->pixel.x - patches[0].at.x, 1.4, 0.1);
  EXPECT_NEAR(place->pixel.y, patches[0].at.y, 0.1);
  EXPECT_GT(place->information[0][0], 1000 * std::abs(place->information[1][1]));
}

}  // namespace alidade
