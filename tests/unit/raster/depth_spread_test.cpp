// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/depth_spread.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace alidade {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

}  // namespace

TEST(DepthSpread, APlaneStaysThePlane) {
  // 1/z is linear on screen: a floor at a slant of 60 px a doubling.
  const auto z = [](double x, double y) { return 1 / (0.1 + 0.0008 * y + 0.0002 * x); };
  DepthImage half(64, 48);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) half.at(x, y) = static_cast<float>(z(2 * x + 0.5, 2 * y + 0.5));
  const DepthImage full = spreadDepth(half);
  ASSERT_EQ(full.width(), 128);
  ASSERT_EQ(full.height(), 96);
  for (int y = 1; y < 95; ++y)
    for (int x = 1; x < 127; ++x) EXPECT_NEAR(full.at(x, y), z(x, y), 1e-4 * z(x, y)) << x << " " << y;
}

TEST(DepthSpread, EdgesAreNotSmearedAndNothingUnknownIsMadeUp) {
  DepthImage half(8, 8, 5.0f);
  for (int y = 0; y < 8; ++y)
    for (int x = 4; x < 8; ++x) half.at(x, y) = y < 4 ? 9.0f : kUnknown;
  half.at(1, 6) = std::numeric_limits<float>::infinity();
  const DepthImage full = spreadDepth(half);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const float from = half.at(x / 2, y / 2), got = full.at(x, y);
      if (std::isnan(from)) { EXPECT_TRUE(std::isnan(got)) << x << " " << y; }
      else { EXPECT_EQ(got, from) << x << " " << y; }
    }
}

TEST(DepthSpread, AnEmptyImageStaysEmpty) { EXPECT_TRUE(spreadDepth(DepthImage()).empty()); }

}  // namespace alidade
