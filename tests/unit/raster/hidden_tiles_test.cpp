// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/hidden_tiles.h"

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

constexpr int kWidth = 200, kHeight = 120;

/// Of level 1: a wall at 5 m with lone cells missing, which are closed; nothing at all right of x = 150.
LevelSurface wall() {
  const SplatLevels levels(kWidth, kHeight, 2);
  std::vector<std::uint32_t> plane(levels.pixels(), ~std::uint32_t{0});
  for (int y = 0; y < levels.rows[1]; ++y)
    for (int x = 0; x < 75 + SplatLevels::kMargin; ++x)
      if (x % 9 != 4 || y % 7 != 3)
        plane[static_cast<std::size_t>(levels.start[1] + y * levels.columns[1] + x)] = std::bit_cast<std::uint32_t>(5.0f);
  SplatPlanes<std::uint32_t> planes;
  planes.planes.push_back({plane.data()});
  return *coarseSurface(planes, levels, true, 2, SurfacePayload::None);
}

/// A box of half a metre's half edge at `middle`, for a camera that looks along z.
SplatRun boxAt(const Camera& camera, const glm::dvec3& middle) {
  SplatRun run;
  run.view = baseView(camera, {});
  run.view.sizeTimesDepth = 1.0f;
  run.boxMiddle = middle;
  run.boxHalf = glm::dmat3(0.5);
  run.nearest = middle.z - 0.5;
  return run;
}

TEST(HiddenTiles, HideWhatLiesBehindAWallWithHolesThatAreClosed) {
  HiddenTiles tiles(kWidth, kHeight);
  tiles.look(wall());
  EXPECT_NEAR(tiles.farthest()[5 * tiles.columns() + 6], 5.0f, 0.2f);
  EXPECT_EQ(tiles.farthest()[5 * tiles.columns() + 18], std::numeric_limits<float>::infinity());

  const Camera camera = test::pinhole(kWidth, kHeight, 150);
  EXPECT_TRUE(tiles.hides(boxAt(camera, {-1, 0, 10})));
  EXPECT_FALSE(tiles.hides(boxAt(camera, {-1, 0, 5})));  // reaches before the wall
  EXPECT_FALSE(tiles.hides(boxAt(camera, {3, 0, 10})));  // right of the wall
  EXPECT_FALSE(tiles.hides(boxAt(camera, {0, 0, 0.3})));  // about the eye
}

/// A wall near the eye before a room of points: with those that lie behind it, so many that tiles are looked at, or without them,
/// the picture is the same.
TEST(HiddenTiles, LeaveThePictureAsItIs) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Camera camera = test::pinhole(320, 240, 200);
  PointBatch all, seen;
  for (int i = 0; i < 560'000; ++i) {
    const bool isWall = i % 7 == 0;
    const glm::dvec3 p = isWall ? glm::dvec3(-2 + 3 * unit(random), -2 + 4 * unit(random), 3) : glm::dvec3(-8 + 16 * unit(random), -6 + 12 * unit(random), 6 + 8 * unit(random));
    all.position.push_back(p);
    // As seen from the eye at the wall's distance; a coarse cell's width within its border.
    const bool isBehind = !isWall && 3 * p.x / p.z > -1.6 && 3 * p.x / p.z < 0.6;
    if (!isBehind) seen.position.push_back(p);
  }
  const auto picture = [&](const PointBatch& batch) {
    const auto store = test::storeFrom(batch);
    Selection selection = selectAll(*store, camera, {});
    for (SelectedRange& range : selection.ranges) range.spacing = 0.05;  // as wide, whatever is in the node
    return splat({{store, selection}}, camera, {}, {}).depth;
  };
  const DepthImage whole = picture(all), front = picture(seen);
  std::size_t different = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) different += std::abs(1 / whole.data()[i] - 1 / front.data()[i]) > 1e-3;
  EXPECT_LE(different, 5u);
}

}  // namespace
}  // namespace alidade
