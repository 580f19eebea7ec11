// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "survey/design_stream.h"

namespace alidade {
namespace {

DesignStream sample() {
  DesignStream design;
  DesignModel& m = design.model;
  m.name = "hall";
  m.crs = "EPSG:2056";
  m.origin = {2683500.0, 1247800.0, 408.0};
  m.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  m.triangles = {0, 1, 2, 0, 2, 3};
  m.edges = {{0, 1}, {1, 2}, {2, 3}, {0, 3}};
  DesignElement a;
  a.globalId = "2O2Fr$t4X7Zf8NOew3FNtn";
  a.name = "Wände";
  a.type = "IfcWall";
  a.storey = "EG";
  a.colour = {1, 2, 3, 4};
  a.properties = {{"Pset_WallCommon.IsExternal", "true"}, {"x", ""}};
  a.indexCount = 3;
  a.edgeCount = 2;
  DesignElement b = a;
  b.globalId = "other";
  b.firstIndex = 3;
  b.firstEdge = 2;
  m.elements = {a, b};
  design.notes = {{"what", "where"}};
  return design;
}

TEST(DesignStream, ComesBackAsItWent) {
  const DesignStream before = sample();
  const auto after = decodeDesign(encodeDesign(before));
  ASSERT_TRUE(after) << after.error().text();
  EXPECT_EQ(after->model.name, before.model.name);
  EXPECT_EQ(after->model.crs, before.model.crs);
  EXPECT_EQ(after->model.origin, before.model.origin);
  EXPECT_EQ(after->model.vertices, before.model.vertices);
  EXPECT_EQ(after->model.triangles, before.model.triangles);
  EXPECT_EQ(after->model.edges, before.model.edges);
  ASSERT_EQ(after->model.elements.size(), 2u);
  EXPECT_EQ(after->model.elements[0].properties, before.model.elements[0].properties);
  EXPECT_EQ(after->model.elements[1].globalId, "other");
  EXPECT_EQ(after->model.elements[1].colour, before.model.elements[1].colour);
  ASSERT_EQ(after->notes.size(), 1u);
  EXPECT_EQ(after->notes[0].where, "where");
}

TEST(DesignStream, IsRefusedWhereverItIsCutOff) {
  const auto bytes = encodeDesign(sample());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decodeDesign(std::span(bytes).first(size))) << size;
  auto longer = bytes;
  longer.push_back({});
  EXPECT_FALSE(decodeDesign(longer));
}

TEST(DesignStream, SurvivesEveryByteBeingWrong) {
  const auto bytes = encodeDesign(sample());
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned char value : {0x00, 0x7F, 0x80, 0xFF}) {
      auto broken = bytes;
      broken[at] = static_cast<std::byte>(value);
      const auto design = decodeDesign(broken);
      if (!design) continue;
      for (const auto& e : design->model.elements) {
        EXPECT_LE(std::uint64_t{e.firstIndex} + e.indexCount, design->model.triangles.size());
        EXPECT_LE(std::uint64_t{e.firstEdge} + e.edgeCount, design->model.edges.size());
      }
      for (const auto index : design->model.triangles) EXPECT_LT(index, design->model.vertices.size());
    }
  }
}

TEST(DesignStream, NamesWhatIsWrong) {
  const auto messageOf = [](auto&& spoil) {
    DesignStream design = sample();
    spoil(design.model);
    const auto decoded = decodeDesign(encodeDesign(design));
    return decoded ? std::string("accepted") : decoded.error().what;
  };
  EXPECT_EQ(messageOf([](DesignModel& m) { m.triangles[4] = 4; }),
            "The converted design holds a triangle with a vertex that does not exist");
  EXPECT_EQ(messageOf([](DesignModel& m) { m.edges[1][0] = 99; }),
            "The converted design holds an edge with a vertex that does not exist");
  EXPECT_EQ(messageOf([](DesignModel& m) { m.vertices[2].y = NAN; }),
            "The converted design holds a vertex that is no number");
  EXPECT_EQ(messageOf([](DesignModel& m) { m.origin.x = INFINITY; }),
            "The converted design holds an origin that is no number");
  EXPECT_EQ(messageOf([](DesignModel& m) { m.elements[1].indexCount = 6; }),
            "The converted design holds an element with triangles that do not exist");
  EXPECT_EQ(messageOf([](DesignModel& m) { m.elements[1].firstIndex = 0; }),
            "The converted design holds an element with a wrong range of triangles");
  EXPECT_EQ(messageOf([](DesignModel& m) { m.elements[1].edgeCount = 0xFFFFFFFF; }),
            "The converted design holds an element with edges that do not exist");
}

TEST(DesignStream, AllocatesNoMoreThanTheBytesThatAreThere) {
  auto bytes = encodeDesign(sample());
  // The vertex count stands behind magic, version, two texts and the origin.
  const std::size_t at = 8 + 4 + 4 + 4 + 9 + 24;
  const std::uint64_t huge = std::uint64_t{1} << 60;
  std::memcpy(bytes.data() + at, &huge, 8);
  EXPECT_FALSE(decodeDesign(bytes));
}

}  // namespace
}  // namespace alidade
