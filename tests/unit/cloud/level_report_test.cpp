// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/level_report.h"

#include <cmath>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

TEST(LevelReport, AHexagonalGridIsTheIdealAndASquareOneFallsShortByItsGeometry) {
  std::vector<glm::dvec3> hexagonal, square, surface;
  for (int row = 0; row < 120; ++row) {
    for (int i = 0; i < 120; ++i) {
      hexagonal.push_back({i + 0.5 * (row % 2), row * std::sqrt(3.0) / 2, 0});
      square.push_back({i, row, 0});
    }
  }
  for (int i = 0; i < 20'000; ++i) surface.push_back({5 + 0.7 * (i % 141), 5 + 0.5 * (i / 141), 0});
  const LevelSpread ideal = spreadOf(hexagonal, surface, std::vector<double>(surface.size(), 120 * 120 * std::sqrt(3.0) / 2 / 20'000));
  EXPECT_NEAR(ideal.idealM, 1.0, 1e-9);
  EXPECT_NEAR(ideal.meanSpacing, 1.0, 1e-9);
  EXPECT_EQ(ideal.holeArea, 0.0);
  EXPECT_NEAR(ideal.largestHole, 1 / std::sqrt(3.0), 0.02);
  const LevelSpread squares = spreadOf(square, surface, std::vector<double>(surface.size(), 120 * 120 / 20'000.0));
  EXPECT_NEAR(squares.meanSpacing, std::sqrt(std::sqrt(3.0) / 2), 1e-9);
}

TEST(LevelReport, BlueNoiseIsSpacedMoreEvenlyThanARandomDraw) {
  PointBatch batch;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> side(0, 20);
  for (int i = 0; i < 200'000; ++i) batch.position.push_back({side(random), side(random), 0.0});
  PointStoreBuilder::Options options;
  options.levels = LevelKind::Random;
  PointStoreBuilder builder(options);
  builder.add(batch);
  const LevelSpread drawn = spreadOfShare(**builder.build(Progress()), 0.05), even = spreadOfShare(*test::storeFrom(batch), 0.05);
  EXPECT_NEAR(static_cast<double>(drawn.points), 10'000, 200);
  EXPECT_NEAR(static_cast<double>(even.points), 10'000, 200);
  // A random point's nearest is 1 / (2 sqrt(density)) away (Clark & Evans 1954).
  EXPECT_NEAR(drawn.meanSpacing, 0.5 / std::sqrt(2 / std::sqrt(3.0)), 0.04);
  EXPECT_GT(even.meanSpacing, 0.65);
  EXPECT_LT(even.holeArea, drawn.holeArea / 10);
  EXPECT_LT(even.largestHole, 1.5);
}

}  // namespace
}  // namespace alidade
