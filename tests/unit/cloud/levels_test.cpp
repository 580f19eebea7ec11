// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/levels.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/point_store.h"

namespace alidade {
namespace {

TEST(LevelLaw, DeepestLevelFollowsThePointCount) {
  // L = floor(log2(N / 8000) / n) + 1, worked by hand.
  EXPECT_EQ(LevelLaw::forPointCount(8000).deepest, 1);
  EXPECT_EQ(LevelLaw::forPointCount(63999).deepest, 1);
  EXPECT_EQ(LevelLaw::forPointCount(64000).deepest, 2);
  EXPECT_EQ(LevelLaw::forPointCount(20'000'000).deepest, 4);  // log2(2500) = 11.29
  EXPECT_EQ(LevelLaw::forPointCount(20'000'000, 2).deepest, 6);
  EXPECT_EQ(LevelLaw::forPointCount(7999).deepest, 0);
  EXPECT_EQ(LevelLaw::forPointCount(1).deepest, 0);
  EXPECT_EQ(LevelLaw::forPointCount(0).deepest, 0);
}

TEST(LevelLaw, AgreesWithThePrintedFormulasInEveryDimension) {
  for (int n = 2; n <= 6; ++n) {
    for (int deepest = 0; deepest <= 13; ++deepest) {
      const LevelLaw law{n, deepest};
      const double all = std::pow(2.0, (n - 1) * (deepest + 1)) - 1.0;
      for (const double u : {0.0, 1e-6, 0.1, 0.25, 0.5, 0.77, 0.999999}) {
        const double level = std::log(all * u + 1.0) / ((n - 1) * std::log(2.0));
        EXPECT_NEAR(law.levelOfUniform(u), level, 1e-8 * (1 + level)) << n << " " << deepest << " " << u;
        const double share = (std::pow(2.0, (n - 1) * level) - 1.0) / all;
        EXPECT_NEAR(law.shareBelow(level), share, 1e-9);
        EXPECT_NEAR(law.shareBelow(law.levelOfShare(u)), u, 1e-9);
      }
      EXPECT_EQ(law.levelOfUniform(0.0), 0.0);
      EXPECT_NEAR(law.levelOfUniform(1.0), deepest + 1, 1e-9);
      EXPECT_DOUBLE_EQ(law.shareBelow(deepest + 1), 1.0);
    }
  }
}

TEST(LevelLaw, OneDimensionIsUniformOverTheLevels) {
  const LevelLaw law{1, 4};
  EXPECT_DOUBLE_EQ(law.levelOfUniform(0.3), 1.5);
  EXPECT_DOUBLE_EQ(law.shareBelow(1.5), 0.3);
}

std::shared_ptr<const PointStore> storeOf(std::size_t count, std::uint32_t seed, int dimensions) {
  PointBatch batch;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.0, 50.0);
  for (std::size_t i = 0; i < count; ++i)
    batch.position.push_back({place(random), place(random), place(random)});
  PointStoreBuilder::Options options;
  options.levels = LevelKind::Random;
  options.seed = seed;
  options.dimensions = dimensions;
  PointStoreBuilder builder(options);
  builder.add(batch);
  return *builder.build(Progress());
}

/// Points below each 64th of a level, over the whole store.
std::vector<std::uint64_t> countsByStep(const PointStore& store) {
  std::vector<std::uint64_t> counts;
  for (int step = 0; step <= 64 * (store.levelLaw().deepest + 1); ++step) {
    std::uint64_t below = 0;
    for (std::uint32_t n = 0; n < store.nodes().size(); ++n)
      below += store.countBelow(n, step / 64.0 - store.lawShift());
    counts.push_back(below);
  }
  return counts;
}

TEST(Levels, TheDrawnLevelsFollowTheLaw) {
  // Kolmogorov-Smirnov: sqrt(n) D exceeds 1.95 once in a thousand; the seeds are fixed.
  for (const int dimensions : {2, 3, 4}) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      const auto store = storeOf(200'000, seed, dimensions);
      const std::vector<std::uint64_t> counts = countsByStep(*store);
      const auto n = static_cast<double>(store->pointCount());
      double largest = 0;
      for (std::size_t step = 0; step < counts.size(); ++step)
        largest = std::max(largest, std::abs(store->levelLaw().shareBelow(static_cast<double>(step) / 64.0) -
                                             static_cast<double>(counts[step]) / n));
      EXPECT_LT(std::sqrt(n) * largest, 1.95) << dimensions << " " << seed;
      EXPECT_EQ(counts.front(), 0u);
      EXPECT_EQ(counts.back(), store->pointCount());
    }
  }
}

TEST(Levels, ASeedRepeatsTheDrawAndAnotherChangesIt) {
  const auto a = storeOf(5000, 1, 3), b = storeOf(5000, 1, 3), c = storeOf(5000, 2, 3);
  EXPECT_EQ(countsByStep(*a), countsByStep(*b));
  EXPECT_NE(countsByStep(*a), countsByStep(*c));
}

}  // namespace
}  // namespace alidade
