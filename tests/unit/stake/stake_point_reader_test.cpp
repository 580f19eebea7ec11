// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "stake/stake_point_reader.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

using testing::HasSubstr;

namespace {

Result<PointList> parsed(const std::string& text) { return parseStakePoints(text, "p.csv"); }

StakePoint only(const std::string& text) {
  const auto list = parsed(text);
  EXPECT_TRUE(list) << list.error().text();
  if (!list) return {};
  EXPECT_EQ(list->points.size(), 1u);
  return list->points.front();
}

void expectPoint(const StakePoint& point, const std::string& name, glm::dvec3 position, const std::string& code = "") {
  EXPECT_EQ(point.name, name);
  EXPECT_EQ(point.position, position);
  EXPECT_EQ(point.code, code);
}

int sniffed(const std::string& text, const std::string& extension) {
  FileProbe probe;
  probe.path = "p." + extension;
  probe.extension = extension;
  probe.head = std::as_bytes(std::span(text.data(), text.size()));
  return StakePointReader().sniff(probe);
}

}  // namespace

TEST(StakePoints, ReadsLinesWithoutAHeader) {
  expectPoint(only("P1,100600.125,196250.5,6.25\n"), "P1", {100600.125, 196250.5, 6.25});
  expectPoint(only("P1,100600.125,196250.5,6.25,axis\n"), "P1", {100600.125, 196250.5, 6.25}, "axis");
  expectPoint(only("12;1;2;3;a,b\n"), "12", {1, 2, 3}, "a,b");
  expectPoint(only("P1\t1\t2\t3\tkerb\n"), "P1", {1, 2, 3}, "kerb");
  expectPoint(only("P1   1 2  3"), "P1", {1, 2, 3});
}

TEST(StakePoints, MapsHeadersInAnyOrder) {
  const auto point = only("Code,H,Northing,Easting,Name,tolerance,remark2\nMH,3,2,1,S7,0.05,x\n");
  expectPoint(point, "S7", {1, 2, 3}, "MH");
  EXPECT_EQ(point.toleranceM, 0.05);
}

TEST(StakePoints, ReadsGermanTables) {
  const auto point = only("\xEF\xBB\xBFPunktnummer;Rechtswert [m];Hochwert [m];Höhe [m];Toleranz (mm);Beschreibung\r\n"
                          "1001;2'600'000,125;1200000,5;431,75;15;\"Schacht; \"\"alt\"\"\"\r\n");
  expectPoint(point, "1001", {2600000.125, 1200000.5, 431.75}, "Schacht; \"alt\"");
  EXPECT_DOUBLE_EQ(point.toleranceM, 0.015);
  EXPECT_EQ(only("Nr;Ost;Nord;H\xf6he\n1;1;2;3\n").position, glm::dvec3(1, 2, 3));
}

TEST(StakePoints, PassesOverRemarksAndEmptyLines) {
  const auto list = parsed("# site north\n\n// second\nname,E,N,H\n\nA,1,2,3\n,,,\nB,4,5,6\n# end\n");
  ASSERT_TRUE(list) << list.error().text();
  EXPECT_EQ(list->points.size(), 2u);
  EXPECT_TRUE(list->warnings.empty());
  EXPECT_EQ(list->points[0].toleranceM, StakePoint().toleranceM);
}

TEST(StakePoints, WarnsOfXyNamesTwiceAndNoNames) {
  const auto xy = parsed("id,x,y,z\n1,10,20,30\n1,10,20,30\n");
  ASSERT_TRUE(xy) << xy.error().text();
  EXPECT_EQ(xy->points[0].position, glm::dvec3(10, 20, 30));
  EXPECT_EQ(xy->warnings.size(), 2u);
  const auto unnamed = parsed("E,N,H\n1,2,3\n");
  ASSERT_TRUE(unnamed);
  EXPECT_EQ(unnamed->points[0].name, "1");
  EXPECT_EQ(unnamed->warnings.size(), 1u);
}

TEST(StakePoints, EastBesideXIsMeant) {
  EXPECT_EQ(only("name,x,y,z,E,N,H\nA,9,9,9,1,2,3\n").position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(only("name,E,N,H,x,y,z\nA,1,2,3,9,9,9\n").position, glm::dvec3(1, 2, 3));
}

TEST(StakePoints, RefusesBrokenLinesByNumber) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"name,E,N,H\nA,1,2,3\nB,1,2\n", "line 3", "height is missing"},
      {"name,E,N,H\nA,1,x,3\n", "line 2", "'x' is no number"},
      {"name,E,N,H\nA,nan,2,3\n", "line 2", "not finite"},
      {"name,E,N,H\nA,1e300,2,3\n", "line 2", "beyond"},
      {"name,E,N,H,tol\nA,1,2,3,-1\n", "line 2", "negative"},
      {"name;E;N;H\nA;1.234,5;2;3\n", "line 2", "no number"},
      {"name,E,N,H\nA,\"1,2,3\n", "line 2", "quote"},
      {"name,E,N\nA,1,2\n", "line 1", "no column H"},
      {"name,E,N,H,height\nA,1,2,3,4\n", "line 1", "mean the same"},
      {"name,E [ft],N,H\nA,1,2,3\n", "line 1", "'ft'"},
      {"A,1,2\n", "line 1", "neither a header"},
      {"some words\n", "line 1", "neither a header"},
      {"", "p.csv", "no point"},
      {"name,E,N,H\n", "p.csv", "no point"},
      {"\xff\xfe" "n\0a", "p.csv", "UTF-16"},
  };
  for (const auto& [text, where, what] : cases) {
    const auto list = parsed(text);
    ASSERT_FALSE(list) << text;
    EXPECT_THAT(list.error().where, HasSubstr(where)) << text;
    EXPECT_THAT(list.error().what, HasSubstr(what)) << text;
    EXPECT_FALSE(list.error().advice.empty()) << text;
  }
}

TEST(StakePoints, SurvivesRandomDamage) {
  std::mt19937 random(6);
  const std::string alphabet = ",;\t\"' 0123456789.-e#\n\r\xff\xc3[]()";
  for (int i = 0; i < 10000; ++i) {
    std::string text = "name;E [m];N;Höhe_m;tol;code\nA;1,5;2;3;0.1;\"x;y\"\nB;4;5;6;;z\n";
    for (int k = 0; k < 4; ++k) {
      if (random() % 6 == 0) text.resize(1 + random() % text.size());
      else text[random() % text.size()] = alphabet[random() % alphabet.size()];
    }
    (void)parsed(text);
    (void)sniffed(text, "csv");
  }
}

TEST(StakePoints, ClaimsPointsAndLeavesObservationsAndClouds) {
  EXPECT_GE(sniffed("name,E,N,H\n", "csv"), 50);
  EXPECT_GT(sniffed("P1,1,2,3\n", "csv"), 0);
  EXPECT_GT(sniffed("P1 1 2 3\n", "txt"), 0);
  EXPECT_EQ(sniffed("u,v,e,n,h\n1,2,3,4,5\n", "csv"), 0);
  EXPECT_EQ(sniffed("1.0 2.0 3.0 255 0 0\n", "txt"), 0) << "a cloud";
  EXPECT_EQ(sniffed("0.1 1 2 3 0 0 0 1\n", "txt"), 0) << "a trajectory";
  EXPECT_EQ(sniffed("name,E,N,H\n", "las"), 0);
}

}  // namespace alidade
