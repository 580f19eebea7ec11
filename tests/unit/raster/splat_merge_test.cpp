// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/splat_merge.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace alidade {
namespace {

constexpr int kWidth = 37, kHeight = 29;

/// A picture of pixels of colour x + 100 y at the depth that `depthAt` gives; not finite: nothing there.
template <class DepthAt>
std::vector<std::uint64_t> planeOf(DepthAt depthAt) {
  std::vector<std::uint64_t> plane;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float z = depthAt(x, y);
      const auto payload = static_cast<std::uint32_t>(x + 100 * y);
      plane.push_back(std::isfinite(z) ? std::uint64_t{std::bit_cast<std::uint32_t>(z)} << 32 | payload : ~std::uint64_t{0});
    }
  }
  return plane;
}

struct Picture {
  std::vector<float> depth;  ///< NaN where nothing is
  std::vector<std::uint32_t> payload;
  float at(int x, int y) const { return depth[static_cast<std::size_t>(y * kWidth + x)]; }
};

Picture merged(const std::vector<std::vector<std::uint64_t>>& planes, bool closeHoles, int rowsAtATime = kHeight) {
  SplatPlanes<std::uint64_t> all;
  for (const auto& plane : planes) all.planes.push_back(plane.data());
  Picture picture;
  for (int first = 0; first < kHeight; first += rowsAtATime) {
    MergedRows<std::uint64_t> rows(all, kWidth, kHeight, closeHoles);
    for (int y = first; y < std::min(first + rowsAtATime, kHeight); ++y) {
      const std::uint64_t* row = rows.row(y);
      for (int x = 0; x < kWidth; ++x) {
        picture.depth.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(row[x] >> 32)));
        picture.payload.push_back(static_cast<std::uint32_t>(row[x]));
      }
    }
  }
  return picture;
}

/// A floor: 1/z falls evenly from row to row.
float floorDepth(int, int y) {
  return 1.0f / (0.05f + 0.0005f * static_cast<float>(y));
}

TEST(SplatMerge, NearestOfThePlanesWins) {
  const Picture both = merged({planeOf([](int x, int) { return x % 2 == 0 ? 5.0f : 3.0f; }), planeOf([](int, int) { return 4.0f; })}, false);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) EXPECT_EQ(both.at(x, y), x % 2 == 0 ? 4.0f : 3.0f);
}

TEST(SplatMerge, HolesOfASurfaceAreClosedOnIt) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> kind(0, 9);
  std::vector<int> holes;
  for (int i = 0; i < kWidth * kHeight; ++i) holes.push_back(kind(random));
  // A tenth is bare, a tenth shows a wall far behind.
  const auto withHoles = planeOf([&](int x, int y) {
    const int k = holes[static_cast<std::size_t>(y * kWidth + x)];
    return k == 0 ? INFINITY : k == 1 ? 200.0f : floorDepth(x, y);
  });
  const Picture closed = merged({withHoles}, true);
  std::size_t closedCount = 0;
  for (int y = 2; y + 2 < kHeight; ++y) {
    for (int x = 2; x + 2 < kWidth; ++x) {
      const bool hole = holes[static_cast<std::size_t>(y * kWidth + x)] < 2;
      const float z = closed.at(x, y);
      if (!hole) {
        EXPECT_EQ(z, floorDepth(x, y));
      }
      if (!hole || !(z < 100.0f)) continue;
      ++closedCount;
      EXPECT_NEAR(z, floorDepth(x, y), 0.04f * z);
      const std::uint32_t from = closed.payload[static_cast<std::size_t>(y * kWidth + x)];
      EXPECT_LE(std::abs(static_cast<int>(from % 100) - x) + std::abs(static_cast<int>(from / 100) - y), 2);
      EXPECT_GE(holes[from / 100 * kWidth + from % 100], 2);
    }
  }
  EXPECT_GT(closedCount, 100u);
}

TEST(SplatMerge, EdgesGapsAndTheSkyStayOpen) {
  // Posts 2 pixels wide and 3 apart before a wall, its lower half; above it the sky.
  const auto scene = [](int x, int y) {
    if (y < 10) return INFINITY;
    return x % 5 < 2 ? 4.0f : y < 20 ? INFINITY : 9.0f;
  };
  const Picture closed = merged({planeOf(scene)}, true);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::isfinite(scene(x, y))) {
        EXPECT_EQ(closed.at(x, y), scene(x, y));
      } else {
        EXPECT_TRUE(std::isnan(closed.at(x, y))) << x << ' ' << y;
      }
    }
  }
}

TEST(SplatMerge, BandsGiveTheSamePicture) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> depth(1.0f, 20.0f);
  const auto plane = planeOf([&](int, int) { return depth(random) < 8.0f ? INFINITY : depth(random); });
  const Picture whole = merged({plane}, true), bands = merged({plane}, true, 3);
  EXPECT_EQ(whole.payload, bands.payload);
  for (std::size_t i = 0; i < whole.depth.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint32_t>(whole.depth[i]), std::bit_cast<std::uint32_t>(bands.depth[i]));
}

}  // namespace
}  // namespace alidade
