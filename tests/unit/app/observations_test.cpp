// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "app/jobs.h"

namespace alidade {

namespace {

class Observations : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    const auto path = std::filesystem::temp_directory_path() / "alidade_observations_test.csv";
    std::ofstream(path) << text;
    return path.string();
  }
};

}  // namespace

TEST_F(Observations, ReadWithTheirColumnsInAnyOrder) {
  const auto read = readObservations(write("name,n,e,h,v,u,sigma_px\nP1,1247800.5,2683500.25,412,20,10,0.3\n\n# end\n"));
  ASSERT_TRUE(read) << read.error().text();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->front().name, "P1");
  EXPECT_DOUBLE_EQ(read->front().pixel.x, 10);
  EXPECT_DOUBLE_EQ(read->front().world.x, 2683500.25);
  EXPECT_DOUBLE_EQ(read->front().sigmaPx, 0.3);
}

TEST_F(Observations, NameAndSigmaMayBeMissing) {
  const auto read = readObservations(write("u,v,e,n,h\n1,2,3,4,5\n"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->front().name, "line 2");
  EXPECT_DOUBLE_EQ(read->front().sigmaPx, 0.5);
}

TEST_F(Observations, EachKindOfBadFileNamesItsLine) {
  for (const char* text : {"u,v,e,n\n1,2,3,4\n", "u,v,e,n,h\n1,2,3,4\n", "u,v,e,n,h\n1,2,3,4,nan\n", "u,v,e,n,h\n1,2,x,4,5\n",
                           "u,v,e,n,h,sigma_px\n1,2,3,4,5,-1\n", "u,v,e,n,h\n", ""}) {
    const auto read = readObservations(write(text));
    ASSERT_FALSE(read) << text;
    EXPECT_FALSE(read.error().advice.empty());
  }
  EXPECT_NE(readObservations(write("u,v,e,n,h\n1,2,3,4,5\n1,2,3,4,inf\n")).error().where.find("line 3"), std::string::npos);
  EXPECT_FALSE(readObservations("/nowhere/observations.csv"));
}

}  // namespace alidade
