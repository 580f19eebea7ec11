// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "trajectory/euroc_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace alidade {

using testing::HasSubstr;

namespace {

const std::string kHeader = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n";

Result<CameraSet> parsed(const std::string& text) { return parseEuroc(text, "data.csv", Progress()); }

int score(const std::string& text) {
  FileProbe probe;
  probe.path = "data.csv";
  probe.extension = "csv";
  probe.head = {reinterpret_cast<const std::byte*>(text.data()), text.size()};
  return EurocReader().sniff(probe);
}

}  // namespace

TEST(Euroc, TimesAreNanosecondsAndTheQuaternionBeginsWithW) {
  // A quarter turn about z: w and z. Read as x y z w it would be one about another axis.
  const auto set = parsed(kHeader + "1403636580838555648,4,5,6,0.7071067811865476,0,0,0.7071067811865476,9,9,9\n"
                                    "1403636580843555328,4,5,6,1,0,0,0\n");
  ASSERT_TRUE(set) << set.error().text();
  ASSERT_EQ(set->pictures.size(), 2u);
  EXPECT_NEAR(set->pictures[0].timeSecs, 1403636580.838555648, 1e-6);
  EXPECT_NEAR(set->pictures[1].timeSecs - set->pictures[0].timeSecs, 0.00499968, 3e-7);
  const RigidTransform worldFromBody = set->pictures[0].cameraFromWorld->inverse();
  EXPECT_LT(glm::length(worldFromBody * glm::dvec3(1, 0, 0) - glm::dvec3(4, 6, 6)), 1e-12);
  ASSERT_EQ(set->warnings.size(), 1u);
  EXPECT_THAT(set->warnings[0].what, HasSubstr("body, not of a camera"));
}

TEST(Euroc, BrokenLinesAreRefusedByNumber) {
  for (const char* line : {"1403636580838555648,4,5,6,1,0,0\n", "soon,4,5,6,1,0,0,0\n", "1.5,4,5,6,1,0,0,0\n", "1403636580838555648,x,5,6,1,0,0,0\n",
                           "1403636580838555648,nan,5,6,1,0,0,0\n", "1403636580838555648,4,5,6,0,0,0,0\n", "1403636580838555648,4,5,1e10,1,0,0,0\n"}) {
    const auto set = parsed(kHeader + line);
    ASSERT_FALSE(set) << line;
    EXPECT_THAT(set.error().where, HasSubstr("data.csv, line 2"));
  }
  EXPECT_FALSE(parsed(""));
  EXPECT_FALSE(parsed(kHeader));
}

TEST(Euroc, IsKnownByItsNanosecondsAndItsUnitQuaternion) {
  EXPECT_EQ(score(kHeader + "1403636580838555648,4,5,6,1,0,0,0\n"), 80);
  EXPECT_EQ(score("1403636580838555648,4,5,6,1,2,0,0\n"), 0);
  EXPECT_EQ(score("1,4,5,6,1,0,0,0\n"), 0);
  EXPECT_EQ(score("name,e,n,h\n"), 0);
}

}  // namespace alidade
