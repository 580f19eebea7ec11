// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <numbers>

#include <gtest/gtest.h>

#include "survey/classification.h"
#include "survey/point_style.h"

namespace alidade {
namespace {

bool keeps(const PointStyle& style, const glm::dvec3& p) {
  for (const ClipPlane& plane : style.clipPlanes())
    if (glm::dot(plane.normal, p) < plane.offset) return false;
  return true;
}

TEST(PointStyle, ABoxTurnsClockwiseFromNorth) {
  PointStyle style;
  style.clipBox = {true, {100, 200, 10}, {2, 20, 4}, std::numbers::pi / 2};  // long axis to the east
  EXPECT_EQ(style.clipPlanes().size(), 6u);
  EXPECT_TRUE(keeps(style, {109.9, 200.9, 11.9}));
  EXPECT_FALSE(keeps(style, {110.1, 200, 10}));
  EXPECT_FALSE(keeps(style, {100, 201.1, 10}));
  EXPECT_FALSE(keeps(style, {100, 200, 12.1}));
  style.clipBox.headingRad = std::numbers::pi / 4;  // towards north-east
  EXPECT_TRUE(keeps(style, {106, 206, 10}));
  EXPECT_FALSE(keeps(style, {106, 194, 10}));
}

TEST(PointStyle, ASectionIsASlabOrAHalfSpace) {
  PointStyle style;
  style.section = {true, {5, 5, 5}, 0.0, 0.0, 0.2};  // faces north
  EXPECT_TRUE(keeps(style, {-40, 5.09, 80}));
  EXPECT_FALSE(keeps(style, {5, 5.11, 5}));
  EXPECT_FALSE(keeps(style, {5, 4.89, 5}));
  style.section.thicknessM = 0;
  EXPECT_TRUE(keeps(style, {5, -1000, 5}));
  EXPECT_FALSE(keeps(style, {5, 5.01, 5}));
  style.section.elevationRad = std::numbers::pi / 2;  // faces up: what lies below stays
  EXPECT_TRUE(keeps(style, {0, 0, 4}));
  EXPECT_FALSE(keeps(style, {0, 0, 6}));
}

TEST(PointStyle, CutsLeaveWhatLiesBehindAllOfThem) {
  PointStyle style;
  EXPECT_FALSE(style.filters());
  style.cuts = {{true, {5, 5, 5}, 0.0, 0.0}, {true, {5, 5, 5}, std::numbers::pi / 2, 0.0}};  // a corner: face north and east
  EXPECT_TRUE(style.filters());
  EXPECT_TRUE(keeps(style, {4, 4, 900}));
  EXPECT_FALSE(keeps(style, {4, 5.1, 5}));
  EXPECT_FALSE(keeps(style, {5.1, 4, 5}));
  style.cuts[1].on = false;
  EXPECT_TRUE(keeps(style, {5.1, 4, 5}));
  style.section = {true, {0, 0, 0}, 0.0, 0.0, 2};
  EXPECT_TRUE(keeps(style, {5.1, 0.5, 5}));
  EXPECT_FALSE(keeps(style, {5.1, 4, 5})) << "box, section and cuts each take their part";
  style.section.on = style.cuts[0].on = false;
  EXPECT_FALSE(style.filters());
}

TEST(Classification, NamesAreThoseOfTheStandard) {
  EXPECT_EQ(classificationName(2), "ground");
  EXPECT_EQ(classificationName(6), "building");
  EXPECT_EQ(classificationName(18), "high noise");
  EXPECT_EQ(classificationName(40), "class 40");
  EXPECT_EQ(classificationName(64), "user class 64");
}

TEST(Classification, ListsReadBackAndRefuseWhatIsNoClass) {
  for (const char* text : {"", "0", "7 18", "0 1 2 255"}) EXPECT_EQ(textOfClasses(*classesOfText(text)), text);
  EXPECT_EQ(textOfClasses(*classesOfText("18,7")), "7 18");
  for (const char* text : {"256", "-1", "ground", "7;8", "1e2"}) EXPECT_FALSE(classesOfText(text)) << text;
}

}  // namespace
}  // namespace alidade
