// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "lenses.h"

namespace alidade {
namespace {

/// Towards a pole of the model pixels run to infinity, and a double holds them to less than 1e-6 px.
/// Twenty pictures away is as far as anything is asked.
bool isNear(const Camera& camera, const glm::dvec2& pixel) {
  const double reach = 20.0 * camera.width();
  return std::abs(pixel.x) < reach && std::abs(pixel.y) < reach;
}

class Inverse : public testing::TestWithParam<NamedCamera> {};

/// Directions all over the domain, far beyond the picture too: r up to 3 (72 degrees off the axis).
TEST_P(Inverse, FindsEveryDirectionOfTheDomainAgain) {
  const Camera camera(GetParam().intrinsics);
  const double focal = camera.intrinsics().fx;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  int checked = 0;
  double worstPixel = 0, worstDirection = 0;
  for (int i = 0; i < 20000; ++i) {
    const double angle = 2 * std::numbers::pi * unit(random);
    const double limit = std::min(camera.domain().limitAlong(angle), 3.0);
    const double r = limit * std::sqrt(unit(random));
    const glm::dvec3 ray(r * std::cos(angle), r * std::sin(angle), 1);
    const auto pixel = camera.project(ray);
    if (!pixel) {
      EXPECT_GT(r, 0.99 * limit) << "refused inside its own domain";
      continue;
    }
    const auto back = camera.unproject(*pixel);
    ASSERT_TRUE(back) << "r " << r << " angle " << angle << " of limit " << limit;
    if (!isNear(camera, *pixel)) continue;
    const auto again = camera.project(*back);
    ASSERT_TRUE(again) << "r " << r << " angle " << angle;
    worstPixel = std::max(worstPixel, glm::length(*again - *pixel));
    // On the fold itself a pixel says little of the direction; a hundredth inside it says all.
    if (r < 0.99 * limit) worstDirection = std::max(worstDirection, focal * glm::length(*back - ray));
    ++checked;
  }
  EXPECT_GT(checked, 10000);
  EXPECT_LT(worstPixel, 1e-6);
  EXPECT_LT(worstDirection, 1e-6);
}

/// Every pixel of the picture: either the direction that it names comes back to it, or no direction
/// of a dense sample of the domain lands there.
TEST_P(Inverse, AnswersForEveryPixelThatTheDomainReachesAndNoOther) {
  const Camera camera(GetParam().intrinsics);
  const int columns = 48, rows = 48;
  std::vector<int> reached(columns * rows, 0);
  for (int i = 0; i < 720; ++i) {
    const double angle = 2 * std::numbers::pi * i / 720;
    const double last = std::atan(std::min(camera.domain().limitAlong(angle), 1e3));
    for (int j = 0; j < 400; ++j) {
      const double r = std::tan(last * j / 400);
      const auto pixel = camera.project({r * std::cos(angle), r * std::sin(angle), 1});
      if (!pixel || !camera.inPicture(*pixel)) continue;
      const int u = static_cast<int>((pixel->x + 0.5) / camera.width() * columns);
      const int v = static_cast<int>((pixel->y + 0.5) / camera.height() * rows);
      reached[v * columns + u]++;
    }
  }
  for (int v = 0; v < rows; ++v)
    for (int u = 0; u < columns; ++u) {
      const glm::dvec2 pixel((u + 0.5) / columns * camera.width() - 0.5, (v + 0.5) / rows * camera.height() - 0.5);
      const auto ray = camera.unproject(pixel);
      if (ray) {
        const auto again = camera.project(*ray);
        ASSERT_TRUE(again);
        EXPECT_LT(glm::length(*again - pixel), 1e-6);
      } else {
        // Its cell may be touched by the border of the domain, but not covered.
        bool covered = true;
        for (int dv = -1; dv <= 1; ++dv)
          for (int du = -1; du <= 1; ++du) {
            const int c = u + du, r = v + dv;
            const bool inGrid = c >= 0 && c < columns && r >= 0 && r < rows;
            covered = covered && inGrid && reached[r * columns + c] > 0;
          }
        EXPECT_FALSE(covered) << "no direction for pixel " << pixel.x << " " << pixel.y;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(Lenses, Inverse, testing::ValuesIn(lensCatalogue()),
                         TestNamer());

TEST(InverseLimits, APixelBeyondTheFoldHasNoDirection) {
  const Camera camera(made(CameraModel::OpenCv5, 1920, 1080, {700, 700, 960, 540, -0.35, 0.05, 0, 0, 0}));
  ASSERT_TRUE(std::isfinite(camera.foldBackRadius()));
  const double edge = camera.projectUnchecked({camera.foldBackRadius(), 0, 1}).x;
  ASSERT_LT(edge, 1919);
  EXPECT_TRUE(camera.unproject({edge - 0.01, 540}));
  EXPECT_FALSE(camera.unproject({edge + 0.01, 540}));
}

TEST(InverseLimits, NothingIsSaidOfPixelsThatAreNoNumber) {
  const Camera camera(droneCamera());
  EXPECT_FALSE(camera.unproject({std::nan(""), 3}));
  EXPECT_FALSE(camera.unproject({INFINITY, 3}));
  EXPECT_FALSE(camera.project({std::nan(""), 0, 1}));
  EXPECT_FALSE(camera.project({0, 0, std::nan("")}));
  EXPECT_FALSE(camera.project({0, 0, 0}));
  EXPECT_FALSE(camera.project({0, 0, -1}));
  EXPECT_FALSE(camera.sees(std::nan(""), 0));
  EXPECT_FALSE(Camera(made(CameraModel::Pinhole, 64, 48, {50, 50, 32, 24})).project({INFINITY, 0, 1}));
}

/// Lenses drawn at random, wilder than any that is sold.
TEST(InverseLimits, RandomLensesRoundTripOverTheirDomain) {
  std::mt19937_64 random(99);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  int lenses = 0, checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Intrinsics in = made(CameraModel::BrownHighOrder, 2000, 1500,
                         {1500, 1480, 1000, 750, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    Distortion& d = in.distortion;
    for (int i = 0; i < 6; ++i) d.k[i] = 0.2 * normal(random) / (1 << i);
    for (int i = 0; i < 3; ++i) d.q[i] = trial % 2 ? 0.15 * normal(random) / (1 << i) : 0;
    d.p1 = 0.01 * normal(random), d.p2 = 0.01 * normal(random);
    for (double& s : d.s) s = 0.005 * normal(random);
    for (double& t : d.t) t = 0.1 * normal(random);
    d.shear = 0.005 * normal(random), d.skew = 0.005 * normal(random);
    d.tauX = 0.05 * normal(random), d.tauY = 0.05 * normal(random);
    const Camera camera(in);
    ++lenses;
    for (int i = 0; i < 200; ++i) {
      const double angle = 2 * std::numbers::pi * unit(random);
      const double limit = std::min(camera.domain().limitAlong(angle), 3.0);
      const double r = 0.99 * limit * std::sqrt(unit(random));
      const auto pixel = camera.project({r * std::cos(angle), r * std::sin(angle), 1});
      ASSERT_TRUE(pixel) << "lens " << trial << " r " << r << " of " << limit;
      const auto back = camera.unproject(*pixel);
      ASSERT_TRUE(back) << "lens " << trial << " r " << r << " of " << limit << " angle " << angle;
      const auto again = camera.project(*back);
      ASSERT_TRUE(again);
      if (!isNear(camera, *pixel)) continue;
      EXPECT_LT(glm::length(*again - *pixel), 1e-6) << "lens " << trial;
      ++checked;
    }
  }
  EXPECT_GT(checked, lenses * 180);
}

}  // namespace
}  // namespace alidade
