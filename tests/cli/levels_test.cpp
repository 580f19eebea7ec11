// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Blue-noise levels beside random ones, as a user compares them.

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "command_line.h"

namespace alidade::test {

namespace {

/// A level square of 20 m with points anywhere on it, darker to one side.
std::filesystem::path square() {
  const std::filesystem::path path = scratch() / "square.xyz";
  std::ofstream file(path);
  std::uint64_t state = 7;
  const auto unit = [&state] {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) * 0x1p-53;
  };
  for (int i = 0; i < 60'000; ++i) {
    const double x = 20 * unit(), y = 20 * unit();
    const int shade = static_cast<int>(12 * x);
    file << x << ' ' << y << " 0 " << shade << ' ' << shade << ' ' << shade << '\n';
  }
  return path;
}

}  // namespace

TEST(Levels, RandomLevelsAreSpacedAsTheLawOfRandomPointsSaysAndDrawWorsePictures) {
  const auto outcome = alidadeCli("levels --json " + quoted(square()));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
  const auto answer = outcome.json();
  EXPECT_EQ(answer["points"], 60'000);
  ASSERT_EQ(answer["levels"].size(), 6u);
  double lastWrong = 0;
  for (std::size_t i = 0; i < 6; i += 2) {
    const auto &even = answer["levels"][i], &drawn = answer["levels"][i + 1];
    EXPECT_EQ(even["levels"], "blue-noise");
    EXPECT_EQ(drawn["levels"], "random");
    const double wanted = 60'000 * even["share"].get<double>();
    EXPECT_NEAR(even["points"].get<double>(), wanted, 0.02 * wanted);
    EXPECT_NEAR(drawn["points"].get<double>(), wanted, 0.02 * wanted);
    // A random point's nearest is 1 / (2 sqrt(density)) away (Clark and Evans 1954), of the hexagonal ideal:
    EXPECT_NEAR(drawn["mean_spacing"].get<double>(), 0.5 / std::sqrt(2 / std::sqrt(3.0)), 0.04);
    EXPECT_GT(even["mean_spacing"].get<double>(), 0.65);
    EXPECT_LT(even["hole_area"].get<double>(), 0.5 * drawn["hole_area"].get<double>());
    EXPECT_LT(even["picture_rms"].get<double>(), drawn["picture_rms"].get<double>());
    EXPECT_LT(even["picture_depth_wrong"].get<double>(), drawn["picture_depth_wrong"].get<double>());
    // Not of the greys: they rise evenly, and are blended between points however far apart.
    EXPECT_GT(even["picture_depth_wrong"].get<double>(), lastWrong) << "fewer points, worse picture";
    lastWrong = even["picture_depth_wrong"].get<double>();
  }
}

TEST(Levels, WhatIsNoScanIsRefused) {
  const auto missing = alidadeCli("levels " + quoted(scratch() / "none.las"));
  EXPECT_EQ(missing.exitCode, 1);
  EXPECT_NE(missing.errors.find("none.las"), std::string::npos) << missing.errors;
  EXPECT_EQ(alidadeCli("levels --points 10 " + quoted(square())).exitCode, 2);
}

}  // namespace alidade::test
