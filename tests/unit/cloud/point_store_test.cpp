// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/point_store.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "unit/cloud/test_clouds.h"

namespace alidade {
namespace {

using test::storeFrom;
using test::unevenRoom;

void expectEverySourcePoint(const PointStore& store, const PointBatch& batch) {
  ASSERT_EQ(store.pointCount(), batch.size());
  std::vector<char> seen(batch.size(), 0);
  for (std::uint64_t i = 0; i < store.pointCount(); ++i) {
    const std::uint64_t source = store.sourceIndex(i);
    ASSERT_LT(source, batch.size());
    ASSERT_FALSE(seen[source]) << "twice " << source;
    seen[source] = 1;
    const glm::dvec3 p = store.sourcePosition(i);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(p[axis]),
                std::bit_cast<std::uint64_t>(batch.position[source][axis]));
    }
    if (!batch.rgb.empty()) {
      ASSERT_EQ(store.sourceColour(i), batch.rgb8(source));
    }
  }
}

/// Every rule of CloudNode's comment.
void expectSoundTree(const PointStore& store) {
  const auto nodes = store.nodes();
  std::vector<int> parents(nodes.size(), 0);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> runs;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const CloudNode& node = nodes[n];
    EXPECT_DOUBLE_EQ(node.size, 65536 * node.step);
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
    for (std::uint64_t i = node.first; i < node.first + node.count; ++i) {
      const DisplayPoint& p = store.points()[i];
      const glm::dvec3 shown = node.origin + glm::dvec3(p.x, p.y, p.z) * node.step;
      const glm::dvec3 away = glm::abs(shown - store.sourcePosition(i));
      ASSERT_LE(std::max({away.x, away.y, away.z}), 0.5001 * node.step);
      ASSERT_TRUE(node.bounds.contains(store.sourcePosition(i)));
      ASSERT_TRUE(i == node.first || store.levels()[i] >= store.levels()[i - 1]);
      ASSERT_TRUE(node.childCount == 0 || store.levels()[i] < node.depth + 1.0f);
    }
    if (node.count > 16) {
      EXPECT_LE(node.step, 1e-3);
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
  EXPECT_TRUE(std::equal(store->levels().begin(), store->levels().end(), atOnce->levels().begin()));
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
  std::set<std::uint64_t> sources;
  for (std::uint64_t i = 0; i < 997; ++i) {
    sources.insert(store->sourceIndex(i));
    EXPECT_EQ(store->sourcePosition(i), batch.position[store->sourceIndex(i)]);
  }
  EXPECT_EQ(sources.size(), 997u);
  EXPECT_FALSE(sources.contains(3));
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
    EXPECT_EQ(store->points()[i].rgb565, store->sourceIndex(i) == 0 ? 0x0000 : 0xffff);
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

TEST(PointStore, APrefixIsAnEvenlyThinnedNode) {
  // The share of a dense and a sparse half below a level is the law's in both.
  const PointBatch batch = unevenRoom(300'000);
  const auto store = storeFrom(batch);
  const double share = 0.2;
  const double level = store->levelLaw().levelOfShare(share);
  std::uint64_t near = 0, nearBelow = 0, far = 0, farBelow = 0;
  for (std::uint64_t i = 0; i < store->pointCount(); ++i) {
    const bool isNear = glm::length(store->sourcePosition(i)) < 3.0, below = store->levels()[i] < level;
    (isNear ? near : far) += 1;
    (isNear ? nearBelow : farBelow) += below;
  }
  EXPECT_NEAR(nearBelow / double(near), share, 0.01);
  EXPECT_NEAR(farBelow / double(far), share, 0.01);
}

}  // namespace
}  // namespace alidade
