// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "inspect/deviation.h"

#include <random>

#include <gtest/gtest.h>

namespace alidade {

namespace {

constexpr glm::dvec3 kSite(2'683'500.0, 1'247'800.0, 412.0);

void addQuad(DesignModel& model, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
  const auto base = static_cast<std::uint32_t>(model.vertices.size());
  for (const auto& p : {corner, corner + u, corner + u + v, corner + v}) model.vertices.push_back(p);
  DesignElement element;
  element.firstIndex = static_cast<std::uint32_t>(model.triangles.size());
  element.indexCount = 6;
  model.elements.push_back(element);
  for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) model.triangles.push_back(base + i);
}

}  // namespace

TEST(Deviation, FindsTheOffsetOfAShiftedWallAndLeavesTheFloorAlone) {
  DesignModel design;
  design.origin = kSite;
  addQuad(design, {0, 0, 0}, {10, 0, 0}, {0, 10, 0});  // floor, normal up
  addQuad(design, {0, 0, 0}, {0, 0, 3}, {10, 0, 0});   // wall y = 0, normal along +y
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(0.5, 9.5), up(0.3, 2.9);
  std::normal_distribution<double> noise(0.0, 0.002);
  PointBatch batch;
  for (int i = 0; i < 20'000; ++i) {
    batch.position.push_back(kSite + glm::dvec3(along(random), along(random), noise(random)));
    batch.position.push_back(kSite + glm::dvec3(along(random), 0.04 + noise(random), up(random)));
  }
  PointStoreBuilder builder;
  builder.add(batch);
  const auto store = builder.build(Progress());
  ASSERT_TRUE(store);
  const auto found = deviations(**store, design, {}, Progress());
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2u);
  EXPECT_NEAR((*found)[0].medianM, 0.0, 3e-4);
  EXPECT_NEAR((*found)[1].medianM, 0.04, 3e-4);
  EXPECT_GE((*found)[1].points, 19'000u);
}

TEST(Deviation, RefusesASearchDistanceOfNothing) {
  DeviationOptions options;
  options.searchM = 0;
  EXPECT_FALSE(options.validate());
}

}  // namespace alidade
