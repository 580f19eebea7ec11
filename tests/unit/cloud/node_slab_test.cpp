// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/node_slab.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/point_store.h"

namespace alidade {
namespace {

/// 2000 places in a box of this size, turned so that its third axis is `normal`.
std::vector<glm::vec3> boxOf(const glm::dvec3& size, const glm::dvec3& normal, const glm::dvec3& middle) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> side(-0.5, 0.5);
  const glm::dvec3 u = glm::normalize(glm::cross(normal, glm::dvec3(0.3, -0.8, 0.5))), v = glm::cross(normal, u);
  std::vector<glm::vec3> places;
  for (int i = 0; i < 2000; ++i)
    places.push_back(glm::vec3(middle + side(random) * size.x * u + side(random) * size.y * v + side(random) * size.z * normal));
  return places;
}

TEST(NodeSlab, IsThatOfTheBoxThatThePlacesFillEvenly) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 2, -2)), middle(30, -20, 10);
  const NodeSlab slab = slabOf(boxOf({4, 6, 0.3}, normal, middle));
  EXPECT_GT(std::abs(glm::dot(glm::dvec3(slab.normal), normal)), 0.9999);
  EXPECT_NEAR(slab.along, glm::dot(glm::dvec3(slab.normal), middle), 0.01);
  EXPECT_NEAR(slab.thickness, 4 * 0.3 / std::sqrt(12.0), 0.02);
  EXPECT_NEAR(slab.roughness, 4 * 0.3 / std::sqrt(12.0) / 4.0, 0.005);
}

TEST(NodeSlab, AFlatSurfaceShowsTheCosineOfItsAngle) {
  const NodeSlab slab = slabOf(boxOf({0.2, 0.2, 0}, {0, 0, 1}, {0, 0, 0}));
  for (const double degrees : {90.0, 60.0, 30.0, 20.0}) {
    const double angle = degrees * M_PI / 180;
    const glm::dvec3 eye(50 * std::cos(angle), 0, 50 * std::sin(angle));
    EXPECT_NEAR(facingOf(slab, eye, 50.0), std::sin(angle), 0.01) << degrees;
    EXPECT_NEAR(facingOf(slab, -eye, 50.0), std::sin(angle), 0.01) << "from below, " << degrees;
  }
  EXPECT_EQ(facingOf(slab, {50, 0, 0.5}, 50.0), kLeastFacing);
}

TEST(NodeSlab, WhatIsNotFlatOrNotKnownShowsAll) {
  EXPECT_EQ(facingOf(slabOf(boxOf({1, 1, 1}, {0, 0, 1}, {0, 0, 0})), {50, 0, 0.5}, 50.0), 1.0);
  EXPECT_EQ(facingOf(slabOf(boxOf({5, 0.1, 0.1}, {0, 0, 1}, {0, 0, 0})), {0, 50, 0.5}, 50.0), 1.0);
  const std::vector<glm::vec3> few(3, glm::vec3(1));
  EXPECT_EQ(facingOf(slabOf(few), {50, 0, 0.5}, 50.0), 1.0);
  EXPECT_EQ(facingOf(slabOf({}), {50, 0, 0.5}, 50.0), 1.0);
  const std::vector<glm::vec3> oneAbove(100, glm::vec3(1));
  EXPECT_EQ(facingOf(slabOf(oneAbove), {1, 1, 1}, 0.0), 1.0);
}

TEST(NodeSlab, OfANodeIsThatOfAllOfIt) {
  // A floor and a wall that meet: whichever levels and however dense, as if it were of every point.
  std::mt19937 random(6);
  std::uniform_real_distribution<double> side(0.0, 1.0);
  int looked = 0;
  for (const LevelKind levels : {LevelKind::BlueNoise, LevelKind::Random}) {
    for (const int count : {500, 60'000}) {
      PointBatch batch;
      for (int i = 0; i < count; ++i) {
        const double x = side(random), y = side(random);
        batch.position.push_back(i % 2 == 0 ? glm::dvec3(x, y, 0) : glm::dvec3(x, 1, y));
      }
      PointStoreBuilder::Options options;
      options.levels = levels;
      options.leafPoints = 1'000'000;
      PointStoreBuilder builder(options);
      builder.add(std::move(batch));
      const auto store = builder.build(Progress());
      ASSERT_TRUE(store) << store.error().text();
      for (const CloudNode& node : (*store)->nodes()) {
        if (node.count < 200) continue;
        std::vector<glm::vec3> all;
        for (std::uint32_t i = 0; i < node.count; ++i) {
          const DisplayPoint& p = (*store)->points()[node.first + i];
          all.push_back(glm::vec3(node.step * glm::dvec3(p.x, p.y, p.z)));
        }
        const NodeSlab whole = slabOf(all);
        // What is covered is an estimate: some of a whole surface may count as open, which only costs points.
        EXPECT_GT(node.slab.roughness, whole.roughness - 0.1) << static_cast<int>(levels) << ' ' << count;
        EXPECT_LT(node.slab.roughness, whole.roughness + 0.3) << static_cast<int>(levels) << ' ' << count;
        EXPECT_GT(std::abs(glm::dot(node.slab.normal, whole.normal)), whole.roughness < 0.5f ? 0.95 : 0.0);
        ++looked;
      }
    }
  }
  EXPECT_GE(looked, 4);
}

TEST(NodeSlab, BarsInAPlaneAreNoSurface) {
  // A fence in the plane y = 0: bars of 2 cm, one every 20 cm, scanned every 5 mm; and a board as large, scanned every 3 cm.
  std::mt19937 random(6);
  std::uniform_real_distribution<double> side(0.0, 1.0);
  PointBatch fence, board;
  for (int i = 0; i < 16'000; ++i) {
    const double round = 6.2831853 * side(random);
    fence.position.push_back({0.2 * std::floor(10 * side(random)) + 0.01 * std::cos(round), 0.01 * std::sin(round), side(random)});
  }
  for (int i = 0; i < 2'000; ++i) board.position.push_back({1.8 * side(random), 0.0, side(random)});
  const auto leastFacing = [](PointBatch batch) {
    PointStoreBuilder builder;
    builder.add(std::move(batch));
    const auto store = builder.build(Progress());
    double least = 1;
    for (const CloudNode& node : (*store)->nodes())
      if (node.count > 0) least = std::min(least, facingOf(node.slab, glm::dvec3(20, -0.5, 0.5) - node.origin, 18.0));
    return least;
  };
  EXPECT_GT(leastFacing(std::move(fence)), 0.6);
  EXPECT_LT(leastFacing(std::move(board)), 0.45);
}

}  // namespace
}  // namespace alidade
