// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_store.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <cstring>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

using test::storeFrom;
using test::unevenRoom;

/// A point's coordinates and colour as bits, to compare as multisets.
std::vector<std::array<std::uint64_t, 4>> bitsOf(const PointBatch& batch) {
  std::vector<std::array<std::uint64_t, 4>> bits;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    std::uint64_t colour = 0;
    if (!batch.rgb.empty()) colour = batch.rgb[i].r | std::uint64_t{batch.rgb[i].g} << 16 | std::uint64_t{batch.rgb[i].b} << 32;
    bits.push_back({std::bit_cast<std::uint64_t>(batch.position[i].x), std::bit_cast<std::uint64_t>(batch.position[i].y),
                    std::bit_cast<std::uint64_t>(batch.position[i].z), colour});
  }
  std::sort(bits.begin(), bits.end());
  return bits;
}

void expectEverySourcePoint(const PointStore& store, const PointBatch& batch) {
  ASSERT_EQ(store.pointCount(), batch.size());
  const PointBatch back = store.batch(0, store.pointCount());
  EXPECT_TRUE(bitsOf(back) == bitsOf(batch));
  for (std::uint64_t i = 0; i < store.pointCount(); i += 97) ASSERT_EQ(store.sourcePosition(i), back.position[i]);
}

/// Every rule of CloudNode's comment.
void expectSoundTree(const PointStore& store) {
  const auto nodes = store.nodes();
  std::vector<int> parents(nodes.size(), 0);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> runs;
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    const CloudNode& node = nodes[n];
    EXPECT_DOUBLE_EQ(node.size, std::ldexp(nodes[0].size, -static_cast<int>(node.depth)));
    if (node.count > 0) runs.push_back({node.first, node.count});
    for (std::uint32_t c = 0; c < node.childCount; ++c) {
      const std::size_t child = node.firstChild + c;
      ASSERT_GT(child, n);
      ASSERT_LT(child, nodes.size());
      ++parents[child];
      EXPECT_GT(nodes[child].depth, node.depth);
      EXPECT_TRUE(glm::all(glm::lessThanEqual(node.bounds.min, nodes[child].bounds.min)));
      EXPECT_TRUE(glm::all(glm::greaterThanEqual(node.bounds.max, nodes[child].bounds.max)));
    }
    const NodeLevels levels = store.levelsOf(n);
    ASSERT_TRUE(std::is_sorted(levels.cumulative.begin(), levels.cumulative.end()));
    if (node.count > 0) {
      ASSERT_EQ(levels.cumulative.back(), node.count);
    }
    for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
      const DisplayPoint& p = store.points()[i];
      const glm::dvec3 shown = node.origin + glm::dvec3(p.x, p.y, p.z) * node.step;
      const glm::dvec3 away = glm::abs(shown - store.sourcePosition(i));
      ASSERT_LE(std::max({away.x, away.y, away.z}), 0.5001 * node.step);
      ASSERT_TRUE(node.bounds.contains(store.sourcePosition(i)));
    }
  }
  EXPECT_EQ(parents[0], 0);
  EXPECT_TRUE(std::all_of(parents.begin() + 1, parents.end(), [](int p) { return p == 1; }));
  std::sort(runs.begin(), runs.end());
  std::uint64_t next = 0;
  for (const auto& [first, count] : runs) {
    EXPECT_EQ(first, next);
    next = first + count;
  }
  EXPECT_EQ(next, store.pointCount());
}

TEST(PointStore, GivesEverySourcePointBackBitForBit) {
  for (const double far : {0.0, 1e7}) {
    PointBatch batch = unevenRoom(120'000, glm::dvec3(far, -far, 0));
    batch.position[17] += glm::dvec3(1e-9, 3e-9, -1.0 / 3.0);
    const auto store = storeFrom(batch, 3000);
    expectEverySourcePoint(*store, batch);
    expectSoundTree(*store);
    EXPECT_GT(store->nodes().size(), 20u);
  }
}

TEST(PointStore, CountsOverAllBatchesAndKeepsTheirOrder) {
  const PointBatch whole = unevenRoom(30'000);
  PointStoreBuilder builder;
  for (std::size_t first = 0; first < whole.size(); first += 7000) {
    PointBatch part;
    const std::size_t last = std::min(first + 7000, whole.size());
    part.position.assign(whole.position.begin() + first, whole.position.begin() + last);
    part.rgb.assign(whole.rgb.begin() + first, whole.rgb.begin() + last);
    builder.add(part);
  }
  const auto store = *builder.build(Progress());
  expectEverySourcePoint(*store, whole);
  const auto atOnce = storeFrom(whole);
  EXPECT_TRUE(std::equal(store->points().begin(), store->points().end(), atOnce->points().begin(),
                         [](const DisplayPoint& a, const DisplayPoint& b) { return std::memcmp(&a, &b, sizeof a) == 0; }));
}

TEST(PointStore, LeavesNonFinitePointsOutAndCountsThem) {
  PointBatch batch = unevenRoom(1000);
  batch.position[3].x = std::numeric_limits<double>::quiet_NaN();
  batch.position[500].y = std::numeric_limits<double>::infinity();
  batch.position[999].z = -1e300;
  PointStoreBuilder builder;
  builder.add(batch);
  EXPECT_EQ(builder.droppedCount(), 3u);
  const auto store = *builder.build(Progress());
  ASSERT_EQ(store->pointCount(), 997u);
  PointBatch good = batch.every(0, 1);
  for (const std::size_t i : {999, 500, 3}) {
    good.position.erase(good.position.begin() + static_cast<std::ptrdiff_t>(i));
    good.rgb.erase(good.rgb.begin() + static_cast<std::ptrdiff_t>(i));
  }
  expectEverySourcePoint(*store, good);
  EXPECT_LT(store->bounds().diagonal(), 100.0);
}

TEST(PointStore, AnEmptyCloudBuildsAnEmptyStore) {
  PointStoreBuilder builder;
  const auto store = builder.build(Progress());
  ASSERT_TRUE(store);
  EXPECT_EQ((*store)->pointCount(), 0u);
  EXPECT_TRUE((*store)->nodes().empty());
  EXPECT_TRUE((*store)->bounds().empty());
  PointBatch bad;
  bad.position.push_back(glm::dvec3(std::nan("")));
  PointStoreBuilder second;
  second.add(bad);
  EXPECT_EQ((*second.build(Progress()))->pointCount(), 0u);
}

TEST(PointStore, IdenticalPointsEndInOneLeaf) {
  PointBatch batch;
  batch.position.assign(50'000, glm::dvec3(1e7 + 0.125, 12.0, -3.0));
  const auto store = storeFrom(batch, 1000);
  expectEverySourcePoint(*store, batch);
  EXPECT_LT(store->nodes().size(), 30u);
  EXPECT_EQ(store->medianSpacing(), 0.0);
}

TEST(PointStore, SparseCloudsOverGreatDistancesStaySmall) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> far(-1e6, 1e6);
  PointBatch batch;
  for (int i = 0; i < 20'000; ++i) batch.position.push_back({far(random), far(random), far(random)});
  batch.position.push_back({9e7, 0, 0});
  const auto store = storeFrom(batch);
  expectEverySourcePoint(*store, batch);
  expectSoundTree(*store);
  EXPECT_LT(store->nodes().size(), batch.size());
  // Places are kept to a small part of the distance between points.
  for (const CloudNode& node : store->nodes()) EXPECT_LT(node.step, 1000.0);
}

TEST(PointStore, MeasuresTheSpacingOfARegularGrid) {
  PointBatch batch;
  for (int i = 0; i < 400; ++i) {
    for (int j = 0; j < 400; ++j) batch.position.push_back({0.01 * i, 0.01 * j, 5.0});
  }
  const auto store = storeFrom(batch, 5000);
  EXPECT_NEAR(store->medianSpacing(), 0.01, 0.0015);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> side(0.0, 4.0);
  for (auto& p : batch.position) p = {side(random), side(random), 5.0};
  // 10 000 points a square metre, wherever they fall: 1 cm.
  EXPECT_NEAR(storeFrom(batch, 5000)->medianSpacing(), 0.01, 0.0015);
}

TEST(PointStore, IntensityTintsWhatHasNoColour) {
  PointBatch batch;
  batch.position = {{0, 0, 0}, {1, 0, 0}};
  batch.intensity = {0, 400};
  const auto store = storeFrom(batch);
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(store->sourceColour(i).has_value());
    EXPECT_EQ(store->points()[i].rgb565, store->sourcePosition(i).x == 0 ? 0x0000 : 0xffff);
  }
}

TEST(PointStore, CancelsWithTheCommonError) {
  PointStoreBuilder builder;
  builder.add(unevenRoom(10'000));
  const Progress progress;
  progress.cancel();
  const auto store = builder.build(progress);
  ASSERT_FALSE(store);
  EXPECT_TRUE(isCancelled(store.error()));
}

TEST(PointStore, RandomLevelsThinDenseAndSparsePartsAlike) {
  PointStoreBuilder::Options options;
  options.levels = LevelKind::Random;
  PointStoreBuilder builder(options);
  builder.add(unevenRoom(300'000));
  const auto store = *builder.build(Progress());
  const double share = 0.2;
  const double level = store->levelOfShare(share);
  std::uint64_t near = 0, nearBelow = 0, far = 0, farBelow = 0;
  for (std::uint32_t n = 0; n < store->nodes().size(); ++n) {
    const CloudNode& node = store->nodes()[n];
    const std::uint64_t end = node.first + store->countBelow(n, level);
    for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
      const bool isNear = glm::length(store->sourcePosition(i)) < 3.0;
      (isNear ? near : far) += 1;
      (isNear ? nearBelow : farBelow) += i < end;
    }
  }
  EXPECT_NEAR(nearBelow / double(near), share, 0.01);
  EXPECT_NEAR(farBelow / double(far), share, 0.01);
}

}  // namespace
}  // namespace alidade
