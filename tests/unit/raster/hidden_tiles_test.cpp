// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/hidden_tiles.h"

#include <bit>
#include <limits>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

constexpr int kWidth = 200, kHeight = 120;

/// A wall at 5 m with lone pixels missing; nothing at all right of x = 150.
std::vector<std::uint32_t> wall() {
  std::vector<std::uint32_t> plane;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      plane.push_back(x >= 150 || (x % 9 == 4 && y % 7 == 3) ? ~std::uint32_t{0} : std::bit_cast<std::uint32_t>(5.0f));
  return plane;
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
  const std::vector<std::uint32_t> plane = wall();
  HiddenTiles tiles(kWidth, kHeight);
  SplatPlanes<std::uint32_t> planes;
  planes.planes.push_back(plane.data());
  tiles.look(planes);
  EXPECT_NEAR(tiles.farthest()[5 * tiles.columns() + 6], 5.0f, 0.2f);
  EXPECT_EQ(tiles.farthest()[5 * tiles.columns() + 18], std::numeric_limits<float>::infinity());

  const Camera camera = test::pinhole(kWidth, kHeight, 150);
  EXPECT_TRUE(tiles.hides(boxAt(camera, {-1, 0, 10})));
  EXPECT_FALSE(tiles.hides(boxAt(camera, {-1, 0, 5})));  // reaches before the wall
  EXPECT_FALSE(tiles.hides(boxAt(camera, {3, 0, 10})));  // right of the wall
  EXPECT_FALSE(tiles.hides(boxAt(camera, {0, 0, 0.3})));  // about the eye
}

/// A dense wall near the eye before a room of 600 000 points: left out or drawn, what is behind does not show.
TEST(HiddenTiles, LeaveThePictureAsItIs) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  PointBatch batch;
  for (int i = 0; i < 600'000; ++i) {
    if (i % 4 != 0) batch.position.push_back({-8 + 16 * unit(random), -6 + 12 * unit(random), 6 + 8 * unit(random)});
    else batch.position.push_back({-2 + 3 * unit(random), -2 + 4 * unit(random), 3});
  }
  const auto store = test::storeFrom(batch);
  const Camera camera = test::pinhole(320, 240, 200);
  const SplatLayer layer{store, selectAll(*store, camera, {})};
  const SplatImages drawn = splat({layer}, camera, {}, {.pointSize = 2.0}), bare = splat({layer}, camera, {}, {.pointSize = 2.0, .closeHoles = false});
  std::size_t different = 0;
  for (std::size_t i = 0; i < drawn.depth.size(); ++i)
    different += std::isfinite(bare.depth.data()[i]) && drawn.depth.data()[i] > bare.depth.data()[i];
  EXPECT_EQ(different, 0u);
}

}  // namespace
}  // namespace alidade
