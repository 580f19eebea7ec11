// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Making point stores of scans.

#include <fstream>

#include <gtest/gtest.h>

#include "command_line.h"

namespace alidade::test {

namespace {

/// A lattice of points over `side` metres, one every metre, on a survey's coordinates.
std::filesystem::path writeGrid(const std::string& name, int side, int height) {
  const auto path = scratch() / name;
  std::ofstream out(path);
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y) out << 2683500 + x << ".25 " << 1247800 + y << ".5 " << height << ".125\n";
  return path;
}

}  // namespace

TEST(Index, MakesAStoreAppendsToItAndSaysWhatItHolds) {
  const auto low = writeGrid("low.xyz", 100, 400), high = writeGrid("high.xyz", 50, 410);
  const auto store = quoted(scratch() / "grid.alidade-points");
  const auto made = alidadeCli("index --json " + quoted(low) + " -o " + store + " --memory 128M");
  ASSERT_EQ(made.exitCode, 0) << made.errors;
  EXPECT_EQ(made.json()["points"], 10000);
  EXPECT_EQ(made.json()["dropped"], 0);
  EXPECT_EQ(alidadeCli("index --json " + quoted(high) + " -o " + store).exitCode, 1) << "it exists already";
  const auto grown = alidadeCli("index --json --append --levels random --seed 7 " + quoted(high) + " -o " + store);
  ASSERT_EQ(grown.exitCode, 0) << grown.errors;
  EXPECT_EQ(grown.json()["parts"], 2);
  const auto twice = alidadeCli("index --append " + quoted(high) + " -o " + store);
  EXPECT_EQ(twice.exitCode, 1);
  EXPECT_NE(twice.errors.find("holds this scan already"), std::string::npos) << twice.errors;
  const auto info = alidadeCli("info --json " + store);
  ASSERT_EQ(info.exitCode, 0) << info.errors;
  const auto file = info.json()["files"][0];
  EXPECT_EQ(file["kind"], "point_store");
  EXPECT_EQ(file["points"], 12500);
  ASSERT_EQ(file["parts"].size(), 2u);
  EXPECT_EQ(file["parts"][0]["levels"], "blue-noise");
  EXPECT_EQ(file["parts"][1]["levels"], "random");
  EXPECT_EQ(file["parts"][1]["points"], 2500);
  const double bounds[2][3] = {{2683500.25, 1247800.5, 400.125}, {2683599.25, 1247899.5, 410.125}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(file["bounds_m"]["min"][axis].get<double>(), bounds[0][axis], 1e-3);
    EXPECT_NEAR(file["bounds_m"]["max"][axis].get<double>(), bounds[1][axis], 1e-3);
  }
}

TEST(Index, RefusesWhatItCannotDo) {
  const auto scan = writeGrid("refused.xyz", 10, 1);
  const auto store = quoted(scratch() / "refused.alidade-points");
  EXPECT_EQ(alidadeCli("index " + quoted(scan) + " -o " + store + " --memory 12Q").exitCode, 2);
  EXPECT_EQ(alidadeCli("index " + quoted(scan) + " -o " + store + " --levels odd").exitCode, 2);
  EXPECT_EQ(alidadeCli("index " + quoted(scan)).exitCode, 2);
  EXPECT_EQ(alidadeCli("index " + quoted(scan) + " " + quoted(scan) + " -o " + quoted(scratch() / "named_twice")).exitCode, 1);
  EXPECT_EQ(alidadeCli("index --append " + quoted(scan) + " -o " + store).exitCode, 1);
  EXPECT_EQ(alidadeCli("index " + quoted(scratch() / "missing.las") + " -o " + store).exitCode, 1);
  EXPECT_FALSE(std::filesystem::exists(scratch() / "refused.alidade-points"));
}

}  // namespace alidade::test
