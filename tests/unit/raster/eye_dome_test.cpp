// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "raster/eye_dome.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace alidade {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

/// Left half at `left`, right half at `right`, 40 × 30.
DepthImage step(float left, float right) {
  DepthImage depth(40, 30, left);
  for (int y = 0; y < 30; ++y) {
    for (int x = 20; x < 40; ++x) depth.at(x, y) = right;
  }
  return depth;
}

TEST(EyeDome, AStepDarkensItsFarSideAsTheFormulaSays) {
  for (const auto& [nearer, farther] : {std::pair{10.0f, 10.01f}, {3.0f, 3.02f}, {0.7f, 0.701f}, {900.0f, 950.0f}}) {
    for (const double strength : {0.2, 1.0}) {
      const Image<float> shade = eyeDomeShade(step(nearer, farther), {.strength = strength, .radiusPx = 1});
      // Three of the eight neighbours of the first far column are on the near side.
      const double expected = std::exp(-300 * strength * 3.0 / 8.0 * std::log2(double{farther} / nearer));
      for (int y = 1; y < 29; ++y) {
        EXPECT_NEAR(shade.at(20, y), expected, 2e-4) << nearer;
        EXPECT_EQ(shade.at(19, y), 1.0f);
        EXPECT_EQ(shade.at(5, y), 1.0f);
        EXPECT_EQ(shade.at(30, y), 1.0f);
      }
    }
  }
}

TEST(EyeDome, TheRadiusSaysHowFarAStepShades) {
  const Image<float> shade = eyeDomeShade(step(10, 10.005f), {.radiusPx = 4});
  // The ring of radius 4 has its diagonals 3 pixels out.
  const double each = 300.0 / 8 * std::log2(1.0005);
  EXPECT_NEAR(shade.at(20, 15), std::exp(-3 * each), 1e-4);
  EXPECT_NEAR(shade.at(22, 15), std::exp(-3 * each), 1e-4);
  EXPECT_NEAR(shade.at(23, 15), std::exp(-1 * each), 1e-4);
  EXPECT_EQ(shade.at(24, 15), 1.0f);
}

TEST(EyeDome, WhatHasNoDepthNeitherShadesNorIsShaded) {
  for (const float nothing : {kInf, std::numeric_limits<float>::quiet_NaN(), 0.0f}) {
    const Image<float> shade = eyeDomeShade(step(nothing, 5), {.radiusPx = 2});
    for (std::size_t i = 0; i < shade.size(); ++i) EXPECT_EQ(shade.data()[i], 1.0f);
  }
  EXPECT_TRUE(eyeDomeShade(DepthImage(), {}).empty());
}

TEST(EyeDome, ColoursAreMultipliedAndAlphaStays) {
  const DepthImage depth = step(10, 10.02f);
  ColourImage colour(40, 30, Rgba8{200, 100, 50, 77});
  applyEyeDome(depth, {}, colour);
  const double shade = std::exp(-300 * 3.0 / 8 * std::log2(1.002));
  EXPECT_NEAR(colour.at(20, 15).r, 200 * shade, 1.5);
  EXPECT_NEAR(colour.at(20, 15).g, 100 * shade, 1.5);
  EXPECT_NEAR(colour.at(20, 15).b, 50 * shade, 1.5);
  EXPECT_EQ(colour.at(20, 15).a, 77);
  EXPECT_EQ(colour.at(10, 15), (Rgba8{200, 100, 50, 77}));
}

}  // namespace
}  // namespace alidade
