// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <gtest/gtest.h>

#include "survey/design_builder.h"
#include "survey/design_model.h"

namespace alidade {
namespace {

/// Adds an axis-aligned box, two triangles a side, wound outwards.
void addBox(DesignBuilder& builder, const glm::dvec3& low, const glm::dvec3& size) {
  const auto corner = [&](int i) { return low + size * glm::dvec3(i & 1, (i >> 1) & 1, (i >> 2) & 1); };
  const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& s : sides) {
    builder.addTriangle(corner(s[0]), corner(s[1]), corner(s[2]));
    builder.addTriangle(corner(s[0]), corner(s[2]), corner(s[3]));
  }
}

DesignModel oneBox(const glm::dvec3& low, const glm::dvec3& size) {
  DesignBuilder builder;
  builder.beginElement({});
  addBox(builder, low, size);
  DesignBuilder::Summary summary;
  auto model = builder.finish(summary);
  EXPECT_TRUE(model);
  return *model;
}

TEST(FeatureEdges, ABoxHasItsTwelveEdgesAndNoDiagonals) {
  const DesignModel model = oneBox({2683500.123, 1247800.456, 408.789}, {3, 0.25, 2.5});
  EXPECT_EQ(model.edges.size(), 12u);
  double length = 0;
  for (const auto& e : model.edges) length += glm::distance(model.world(e[0]), model.world(e[1]));
  EXPECT_NEAR(length, 4 * (3 + 0.25 + 2.5), 1e-5);
}

TEST(FeatureEdges, FlatTrianglesWoundAgainstEachOtherMakeNoEdgeBetweenThem) {
  DesignBuilder builder;
  builder.beginElement({});
  builder.addTriangle({0, 0, 0}, {1, 0, 0}, {1, 1, 0});
  builder.addTriangle({0, 0, 0}, {0, 1, 0}, {1, 1, 0});  // clockwise
  DesignBuilder::Summary summary;
  const auto model = builder.finish(summary);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->edges.size(), 4u);
}

TEST(FeatureEdges, OneLongSideAgainstTwoShortOnesInAPlaneIsNoEdge) {
  DesignBuilder builder;
  builder.beginElement({});
  builder.addTriangle({0, 0, 0}, {2, 0, 0}, {1, -1, 0});
  builder.addTriangle({0, 0, 0}, {0.5, 1, 0}, {0.75, 0, 0});
  builder.addTriangle({0.75, 0, 0}, {1.5, 1, 0}, {2, 0, 0});
  DesignBuilder::Summary summary;
  const auto model = builder.finish(summary);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->edges.size(), 6u);  // two sides of each triangle
}

TEST(FeatureEdges, OneLongSideAgainstTwoShortOnesAcrossACornerIsDrawnOnce) {
  DesignBuilder builder;
  builder.beginElement({});
  builder.addTriangle({0, 0, 0}, {1, -1, 0}, {2, 0, 0});
  builder.addTriangle({0, 0, 0}, {0.75, 0, 0}, {0.5, 0, 1});
  builder.addTriangle({0.75, 0, 0}, {2, 0, 0}, {1.5, 0, 1});
  DesignBuilder::Summary summary;
  const auto model = builder.finish(summary);
  ASSERT_TRUE(model);
  double along = 0;
  for (const auto& e : model->edges)
    if (std::abs(model->world(e[0]).y) + std::abs(model->world(e[1]).y) + std::abs(model->world(e[0]).z) + std::abs(model->world(e[1]).z) < 1e-6)
      along += glm::distance(model->world(e[0]), model->world(e[1]));
  EXPECT_NEAR(along, 2.0, 1e-6);
}

TEST(FeatureEdges, CornersThatDifferByLessThanTheWeldCountAsOneWhereverTheyLie) {
  // Pairs of triangles that share an edge up to 20 µm, at many positions relative to any grid of cells.
  for (int i = 0; i < 200; ++i) {
    const double at = 1.0 + i * 0.0000123;
    DesignBuilder builder;
    builder.beginElement({});
    builder.addTriangle({at, 0, 0}, {at, 1, 0}, {at - 1, 0, 0});
    builder.addTriangle({at + 0.00002, 1, 0}, {at + 0.00002, 0, 0}, {at + 1, 0, 0});
    DesignBuilder::Summary summary;
    const auto model = builder.finish(summary);
    ASSERT_TRUE(model);
    EXPECT_EQ(model->edges.size(), 4u) << at;
  }
}

TEST(DesignBuilder, KeepsMillimetresFarFromTheOrigin) {
  for (const double far : {0.0, 2.6e6, 1e7}) {
    const glm::dvec3 low(far + 0.123, far + 0.456, 408.789), size(3.001, 0.251, 2.507);
    const Bounds box = oneBox(low, size).bounds();
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(box.min[a], low[a], 1e-6) << far;
      EXPECT_NEAR(box.max[a], low[a] + size[a], 1e-6) << far;
    }
  }
}

TEST(DesignBuilder, LeavesOutTrianglesWithoutAreaAndThoseThatAreNoNumbers) {
  DesignBuilder builder;
  builder.beginElement({});
  builder.addTriangle({0, 0, 0}, {1, 0, 0}, {1, 1, 0});
  builder.addTriangle({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  builder.addTriangle({0, 0, 0}, {1, 0, 0}, {std::nan(""), 0, 0});
  builder.addTriangle({0, 0, 0}, {1, 0, 0}, {0, 1e300, 0});
  builder.beginElement({});
  builder.addTriangle({0, 0, 0}, {0, 0, 0}, {1, 1, 0});
  DesignBuilder::Summary summary;
  const auto model = builder.finish(summary);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->triangles.size(), 3u);
  EXPECT_EQ(model->elements.size(), 1u);
  EXPECT_EQ(summary.degenerate, 2u);
  EXPECT_EQ(summary.notFinite, 2u);
  EXPECT_EQ(summary.emptyElements, 1u);
}

TEST(DesignBuilder, SaysSoWhereNothingIsLeft) {
  DesignBuilder builder;
  DesignBuilder::Summary summary;
  EXPECT_FALSE(builder.finish(summary));
}

TEST(SixfoldVolume, IsExactFarFromTheOrigin) {
  const DesignModel model = oneBox({2.6e6, 1.2e6, 400}, {3, 2, 1});
  std::vector<std::array<glm::dvec3, 3>> triangles;
  for (std::size_t i = 0; i < model.triangles.size(); i += 3)
    triangles.push_back({model.world(model.triangles[i]), model.world(model.triangles[i + 1]), model.world(model.triangles[i + 2])});
  EXPECT_NEAR(sixfoldVolume(triangles), 36.0, 1e-9);
}

}  // namespace
}  // namespace alidade
