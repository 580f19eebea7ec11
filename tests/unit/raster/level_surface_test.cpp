// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/level_surface.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "raster/splat_plane.h"
#include "raster/splatter.h"
#include "unit/raster/panel.h"

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
  for (const auto& plane : planes) all.planes.push_back({plane.data()});
  const SplatLevels levels(kWidth, kHeight, 1);
  Picture picture;
  for (int first = 0; first < kHeight; first += rowsAtATime) {
    SurfaceRows<std::uint64_t> rows(all, levels, 0, closeHoles, SurfacePayload::Other, nullptr);
    for (int y = first; y < std::min(first + rowsAtATime, kHeight); ++y) {
      const SurfaceCells row = rows.row(y);
      for (int x = 0; x < kWidth; ++x) {
        picture.depth.push_back(row.inverse[x] > 0 ? 1.0f / row.inverse[x] : NAN);
        picture.payload.push_back(row.payload[x]);
      }
    }
  }
  return picture;
}

/// A floor: 1/z falls evenly from row to row.
float floorDepth(int, int y) {
  return 1.0f / (0.05f + 0.0005f * static_cast<float>(y));
}

TEST(LevelSurface, NearestOfThePlanesWins) {
  const Picture both = merged({planeOf([](int x, int) { return x % 2 == 0 ? 5.0f : 3.0f; }), planeOf([](int, int) { return 4.0f; })}, false);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) EXPECT_FLOAT_EQ(both.at(x, y), x % 2 == 0 ? 4.0f : 3.0f);
}

TEST(LevelSurface, HolesOfASurfaceAreClosedOnIt) {
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
        EXPECT_FLOAT_EQ(z, floorDepth(x, y));
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

TEST(LevelSurface, EdgesGapsAndTheSkyStayOpen) {
  // Posts 2 pixels wide and 3 apart before a wall, its lower half; above it the sky.
  const auto scene = [](int x, int y) {
    if (y < 10) return INFINITY;
    return x % 5 < 2 ? 4.0f : y < 20 ? INFINITY : 9.0f;
  };
  const Picture closed = merged({planeOf(scene)}, true);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::isfinite(scene(x, y))) {
        EXPECT_FLOAT_EQ(closed.at(x, y), scene(x, y));
      } else {
        EXPECT_TRUE(std::isnan(closed.at(x, y))) << x << ' ' << y;
      }
    }
  }
}

TEST(LevelSurface, BandsGiveTheSamePicture) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> depth(1.0f, 20.0f);
  const auto plane = planeOf([&](int, int) { return depth(random) < 8.0f ? INFINITY : depth(random); });
  const Picture whole = merged({plane}, true), bands = merged({plane}, true, 3);
  EXPECT_EQ(whole.payload, bands.payload);
  for (std::size_t i = 0; i < whole.depth.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint32_t>(whole.depth[i]), std::bit_cast<std::uint32_t>(bands.depth[i]));
}

/// Points of a surface in colours of their own, over all levels.
SplatImages drawn(const PointBatch& batch, const Camera& camera, const RigidTransform& pose, SplatOptions options = {.colour = true}) {
  const auto store = test::storeFrom(batch);
  return splat({{store, selectAll(*store, camera, pose)}}, camera, pose, options);
}

TEST(LevelSurface, IsTheFloorBetweenItsPoints) {
  // 1.5 m below the eye, 2 to 12 m away, seen at 37 to 7 degrees: points 14 to 3 pixels apart.
  const test::Panel floor{{-4, 2, 0}, {8, 0, 0}, {0, 10, 0}};
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 1.5}, {0, 10, 0.5});
  for (const Camera& camera : {test::brown(), test::pinhole(640, 480, 420)}) {
    const test::Score surface = scoreOf(floor, camera, pose, {}, 20'000),
                      facing = scoreOf(floor, camera, pose, {.planar = false, .surface = false}, 20'000);
    RecordProperty("surface_error_permille", std::to_string(1000 * surface.meanError));
    RecordProperty("facing_error_permille", std::to_string(1000 * facing.meanError));
    EXPECT_LT(surface.meanError, 0.003);
    EXPECT_GT(facing.meanError, 0.02);
    EXPECT_LT(surface.missing, 0.005);
    EXPECT_LT(surface.fattened, 0.05);
  }
}

TEST(LevelSurface, HidesAsAWholeWhatLiesBehindIt) {
  // A wall of points 6 pixels apart before one of points that are less than a pixel apart.
  const test::Panel near{{-2, 4, -1.5}, {4, 0, 0}, {0, 0, 3}}, far{{-8, 8, -6}, {16, 0, 0}, {0, 0, 12}};
  PointBatch batch = near.points(4'000);
  batch.rgb.assign(batch.position.size(), {250, 0, 0});
  const PointBatch behind = far.points(800'000);
  batch.position.insert(batch.position.end(), behind.position.begin(), behind.position.end());
  batch.rgb.resize(batch.position.size(), {0, 0, 250});
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const Camera camera = test::pinhole(640, 480, 420);
  // Two scans, so that no node holds points of both.
  PointBatch front, back;
  for (std::size_t i = 0; i < batch.position.size(); ++i) {
    PointBatch& to = batch.rgb[i].r > 0 ? front : back;
    to.position.push_back(batch.position[i]), to.rgb.push_back(batch.rgb[i]);
  }
  std::vector<SplatLayer> layers;
  for (const PointBatch& one : {front, back}) {
    const auto store = test::storeFrom(one);
    layers.push_back({store, selectAll(*store, camera, pose)});
  }
  const SplatImages images = splat(layers, camera, pose, {.colour = true});
  std::size_t seen = 0, through = 0, wrongColour = 0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      // Of the near wall, but for two points' distance along its border.
      const bool isNear = std::abs(x - 319.5) < 210 - 12 && std::abs(y - 239.5) < 157 - 12;
      if (!isNear) continue;
      ++seen;
      through += images.depth.at(x, y) > 4.5f;
      wrongColour += images.colour.at(x, y).b > 20;
    }
  }
  EXPECT_GT(seen, 100'000u);
  EXPECT_EQ(through, 0u);
  EXPECT_EQ(wrongColour, 0u);
}

TEST(LevelSurface, ALonePointIsSeen) {
  PointBatch batch;
  batch.position = {{0, 0, 2}};
  batch.rgb = {{200, 100, 50}};
  const Camera camera = test::pinhole(101, 101, 100);
  const auto store = test::storeFrom(batch);
  for (const double spacing : {0.001, 0.03, 0.1, 0.4}) {  // 0.05 to 20 pixels
    SplatLayer layer{store, selectAll(*store, camera, {})};
    layer.selection.ranges.at(0).spacing = spacing;
    const SplatImages images = splat({layer}, camera, {}, {.colour = true});
    int covered = 0;
    for (std::size_t i = 0; i < images.depth.size(); ++i) covered += std::isfinite(images.depth.data()[i]);
    EXPECT_NEAR(images.depth.at(50, 50), 2.0f, 1e-3f) << spacing;
    EXPECT_NEAR(images.colour.at(50, 50).r, 200, 8);
    const double side = std::exp2(std::ceil(std::log2(std::max(1.0, 50 * spacing))));
    EXPECT_LE(covered, static_cast<int>(side * side)) << spacing;
    EXPECT_GE(covered, static_cast<int>(0.5 * side * side)) << spacing;  // its corners are rounded off
  }
}

TEST(LevelSurface, ColoursAreBlendedAndIdsAreNot) {
  // Left half black, right half white, points 8 pixels apart.
  const test::Panel board{{-2, 4, -1.5}, {4, 0, 0}, {0, 0, 3}};
  PointBatch batch = board.points(2'500);
  for (const glm::dvec3& p : batch.position) batch.rgb.push_back(p.x < 0 ? glm::u8vec3(0) : glm::u8vec3(255));
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const Camera camera = test::pinhole(640, 480, 420);
  const SplatImages images = drawn(batch, camera, pose), withIds = drawn(batch, camera, pose, {.colour = true, .ids = true});
  std::size_t between = 0;
  for (int y = 120; y < 360; ++y) {
    for (int x = 150; x < 490; ++x) {
      const int shade = images.colour.at(x, y).r;
      between += shade > 20 && shade < 235;
      if (x < 300 || x > 340) {
        EXPECT_NEAR(shade, x < 320 ? 0 : 255, 2);
      }
      EXPECT_EQ(images.colour.at(x, y).a, 255);
      ASSERT_GT(withIds.point.at(x, y), 0u);
      ASSERT_LE(withIds.point.at(x, y), batch.position.size());
      const int chosen = withIds.colour.at(x, y).r;
      EXPECT_TRUE(chosen == 0 || chosen == 255);
      EXPECT_NEAR(withIds.depth.at(x, y), images.depth.at(x, y), 1e-4);
    }
  }
  EXPECT_GT(between, 500u);
}

TEST(LevelSurface, IsClosedWhereTheScanIsSparser) {
  const auto pose = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0});
  const SplatImages images = drawn(test::boardWithASparserHalf(), test::pinhole(640, 480, 420), pose, {});
  std::size_t bare = 0;
  for (int y = 120; y < 360; ++y)
    for (int x = 340; x < 500; ++x) bare += std::isinf(images.depth.at(x, y));
  EXPECT_LT(bare, 240 * 160 / 5);  // footprints that face the eye leave three fifths
}

TEST(LevelSurface, WhatWasNotDrawnIntoIsNotLookedAt) {
  // Three threads' planes with patches of dots, none of them in some rows, two of them in some places; what is not said to have been drawn
  // into holds the dots of another frame.
  const SplatLevels levels(300, 120, 4);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> depth(5.0f, 6.0f);
  constexpr std::uint64_t kBare = ~std::uint64_t{0};
  std::vector<std::vector<std::uint64_t>> clean(3, std::vector<std::uint64_t>(levels.pixels(), kBare));
  for (std::size_t k = 0; k < clean.size(); ++k) {
    for (int patch = 0; patch < 6; ++patch) {
      const int level = patch % levels.count, columns = levels.columns[level], rows = levels.rows[level];
      const int left = static_cast<int>(random() % static_cast<unsigned>(columns)), top = static_cast<int>(random() % static_cast<unsigned>(rows));
      for (int y = top; y < std::min(rows, top + 12); ++y)
        for (int x = left; x < std::min(columns, left + 40); ++x)
          if (random() % 3 != 0)
            clean[k][static_cast<std::size_t>(levels.start[level] + y * columns + x)] =
                std::uint64_t{std::bit_cast<std::uint32_t>(depth(random))} << 32 | (random() & 0x7fffffff);
    }
  }
  std::vector<std::vector<std::uint64_t>> stale = clean;
  std::vector<std::vector<std::uint8_t>> touched;
  SplatPlanes<std::uint64_t> whole, pieces;
  for (std::size_t k = 0; k < clean.size(); ++k) {
    std::vector<std::uint8_t>& own = touched.emplace_back((levels.pixels() + SplatPlane::kPiece - 1) / SplatPlane::kPiece, 0);
    for (std::size_t i = 0; i < clean[k].size(); ++i) own[i / SplatPlane::kPiece] |= clean[k][i] != kBare;
    for (std::size_t i = 0; i < clean[k].size(); ++i)
      if (own[i / SplatPlane::kPiece] == 0) stale[k][i] = std::uint64_t{std::bit_cast<std::uint32_t>(1.0f)} << 32;
  }
  for (std::size_t k = 0; k < clean.size(); ++k) {
    whole.planes.push_back({clean[k].data()});
    pieces.planes.push_back({stale[k].data(), touched[k].data()});
  }
  for (const bool closeHoles : {false, true}) {
    for (const SurfacePayload kind : {SurfacePayload::None, SurfacePayload::Colour, SurfacePayload::Other}) {
      const auto expected = coarseSurface(whole, levels, closeHoles, 1, kind), found = coarseSurface(pieces, levels, closeHoles, 1, kind);
      SurfaceRows<std::uint64_t> expectedRows(whole, levels, 0, closeHoles, kind, &*expected), foundRows(pieces, levels, 0, closeHoles, kind, &*found);
      std::size_t cells = 0;
      const auto expectSame = [&](const SurfaceCells& a, const SurfaceCells& b, int columns) {
        for (int x = 0; x < columns; ++x) {
          ASSERT_EQ(a.inverse[x], b.inverse[x]);
          if (!(a.inverse[x] > 0)) continue;
          ++cells;
          if (kind != SurfacePayload::None) { ASSERT_EQ(a.payload[x], b.payload[x]); }
        }
      };
      for (int y = 0; y < levels.rows[1]; ++y) expectSame(expected->cells(y), found->cells(y), levels.columns[1]);
      for (int y = 0; y < levels.rows[0]; ++y) expectSame(expectedRows.row(y), foundRows.row(y), levels.columns[0]);
      EXPECT_GT(cells, 2000u);
    }
  }
}

TEST(LevelSurface, AFrameKeepsNothingOfTheOneBefore) {
  const test::Panel near{{-2, 4, -1.5}, {4, 0, 0}, {0, 0, 3}};
  const PointBatch batch = near.points(60'000);
  const Camera camera = test::pinhole(640, 480, 420);
  const auto at = RigidTransform::cameraLookingAt({0, 0, 0}, {0, 4, 0}), aside = RigidTransform::cameraLookingAt({0, 0, 0}, {3, 4, 1});
  const SplatImages first = drawn(batch, camera, at);
  (void)drawn(batch, camera, aside);
  const SplatImages again = drawn(batch, camera, at);
  for (std::size_t i = 0; i < first.depth.size(); ++i) {
    ASSERT_EQ(first.depth.data()[i], again.depth.data()[i]);
    ASSERT_EQ(first.colour.data()[i], again.colour.data()[i]);
  }
}

TEST(LevelSurface, PointsArePulledUpIntoTheCellsThatTheyLieIn) {
  // A lone row and column of dots of level 0 would not do: pixels apart by three, which level 1 closes.
  const SplatLevels levels(64, 48, 2);
  std::vector<std::uint32_t> plane(levels.pixels(), ~std::uint32_t{0});
  for (int y = 12; y < 36; y += 3)
    for (int x = 20; x < 44; x += 3) plane[static_cast<std::size_t>(y * 64 + x)] = std::bit_cast<std::uint32_t>(4.0f);
  SplatPlanes<std::uint32_t> planes;
  planes.planes.push_back({plane.data()});
  const auto surface = coarseSurface(planes, levels, true, 1, SurfacePayload::None);
  int left = 1000, right = -1, top = 1000, bottom = -1;
  for (int y = 0; y < levels.rows[1]; ++y) {
    for (int x = 0; x < levels.columns[1]; ++x) {
      if (!(surface->inverse.at(x, y) > 0)) continue;
      EXPECT_FLOAT_EQ(surface->inverse.at(x, y), 0.25f);
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
    }
  }
  // Dots from (20, 12) to (41, 33) lie in cells (10, 6) to (20, 16); those at the border are surrounded on three sides alone.
  const int margin = SplatLevels::kMargin;
  EXPECT_GE(left, 10 + margin);
  EXPECT_LE(left, 12 + margin);
  EXPECT_LE(right, 20 + margin);
  EXPECT_GE(right, 18 + margin);
  EXPECT_GE(top, 6 + margin);
  EXPECT_LE(top, 8 + margin);
  EXPECT_LE(bottom, 16 + margin);
  EXPECT_GE(bottom, 14 + margin);
}

TEST(LevelSurface, HolesBetweenFarAndNearAreClosedByTheFarther) {
  // A lone bare pixel whose right neighbours are five times nearer than the others.
  const auto plane = planeOf([](int x, int y) { return x == 18 && y == 14 ? INFINITY : x > 18 ? 2.0f : 10.0f; });
  EXPECT_FLOAT_EQ(merged({plane}, true).at(18, 14), 10.0f);
}

}  // namespace
}  // namespace alidade
