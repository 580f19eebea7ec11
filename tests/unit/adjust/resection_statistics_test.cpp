// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Over 200 seeds: as good as OpenCV's refinement of the same picks, and as good as it says it is.

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "opencv_peer.h"

namespace alidade {
namespace {

constexpr int seeds = 200;

struct Figures {
  double position = 0, rotation = 0;  ///< sums of squares
  void add(const std::array<double, 6>& e) {
    position += e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    rotation += e[3] * e[3] + e[4] * e[4] + e[5] * e[5];
  }
};

TEST(ResectionStatistics, TwentyPicksGiveAPoseNoWorseThanOpenCvAndTheReportedErrorHolds) {
  Figures ours, theirs;
  double nees = 0;
  int outliers = 0, inNees95 = 0, ellipses = 0, held = 0;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Site site = randomSite(seed, 20, 0.5);
    ResectionOptions options;
    const RigidTransform worldFromCamera = site.truth.inverse();
    for (const glm::dvec3 p : {glm::dvec3(0, 0, 12), glm::dvec3(-8, 3, 20), glm::dvec3(5, -2, 15)})
      options.at.push_back(worldFromCamera * p);
    const auto summary = resect(site.camera, site.start, site.picks, options);
    ASSERT_TRUE(summary);
    ASSERT_TRUE(summary->converged) << seed << ": " << summary->reason;
    outliers += summary->outlierCount();
    const auto error = poseError(summary->cameraFromWorld, site.truth);
    ours.add(error);
    theirs.add(poseError(refinedByOpenCv(site), site.truth));

    Eigen::Matrix<double, 6, 6> covariance;
    Eigen::Matrix<double, 6, 1> e;
    for (int i = 0; i < 6; ++i) {
      e[i] = error[i];
      for (int j = 0; j < 6; ++j) covariance(i, j) = summary->covariance[i][j];
    }
    const double one = e.dot(covariance.ldlt().solve(e));
    nees += one;
    inNees95 += one < 12.5916;  // chi², six degrees of freedom, 95 %

    for (const ExpectedError& expected : summary->expected) {
      const glm::dvec2 off = *site.camera.project(site.truth * expected.world) -
                             *site.camera.project(summary->cameraFromWorld * expected.world);
      const double c = std::cos(expected.ellipseAngleRad), s = std::sin(expected.ellipseAngleRad);
      const double along = (c * off.x + s * off.y) / expected.ellipseSemiMajorPx;
      const double across = (-s * off.x + c * off.y) / expected.ellipseSemiMinorPx;
      held += along * along + across * across <= 1;
      ++ellipses;
    }
  }
  const double positionRatio = std::sqrt(ours.position / theirs.position);
  const double rotationRatio = std::sqrt(ours.rotation / theirs.rotation);
  RecordProperty("position_ratio", std::to_string(positionRatio));
  std::printf("position rms %.5f m (OpenCV %.5f), rotation rms %.3g rad (%.3g), ratios %.5f %.5f, NEES %.3f, "
              "NEES within 95 %% %.1f %%, ellipses %.2f %%, outliers %d\n",
              std::sqrt(ours.position / seeds), std::sqrt(theirs.position / seeds), std::sqrt(ours.rotation / seeds),
              std::sqrt(theirs.rotation / seeds), positionRatio, rotationRatio, nees / seeds,
              100.0 * inNees95 / seeds, 100.0 * held / ellipses, outliers);
  // Both stop within a millionth of the same minimum.
  EXPECT_LE(positionRatio, 1.0 + 1e-6);
  EXPECT_LE(rotationRatio, 1.0 + 1e-6);
  // The mean of 200 chi² of six degrees: 6 ± 3.29 sqrt(12/200).
  EXPECT_NEAR(nees / seeds, 6, 0.81);
  EXPECT_GE(inNees95, 0.93 * seeds - 3);
  EXPECT_GE(held, 0.93 * ellipses);
  EXPECT_LE(held, 0.97 * ellipses);
}

TEST(ResectionStatistics, OneThirdToOneHalfOfWrongPicksCostsTheRightOnesNothing) {
  for (const double share : {0.3, 0.4, 0.5})
    for (unsigned seed = 1; seed <= 40; ++seed) {
      Site site = randomSite(seed, 20, 0.5);
      std::mt19937_64 random(seed + 1000);
      std::uniform_real_distribution<double> unit(0, 1);
      const int wrong = static_cast<int>(share * 20);
      std::vector<ResectionObservation> right(site.picks.begin() + wrong, site.picks.end());
      for (int i = 0; i < wrong; ++i) {
        glm::dvec2& pixel = site.picks[i].pixel;
        // From ten pixels off to anywhere in the picture.
        const double angle = 6.283185307 * unit(random), far = 10 * std::pow(60.0, unit(random));
        pixel += far * glm::dvec2(std::cos(angle), std::sin(angle));
      }
      const auto all = resect(site.camera, site.start, site.picks);
      const auto clean = resect(site.camera, site.start, right);
      ASSERT_TRUE(all && clean);
      ASSERT_TRUE(all->converged) << share << " seed " << seed << ": " << all->reason;
      ASSERT_TRUE(clean->converged) << clean->reason;
      for (int i = 0; i < wrong; ++i) EXPECT_TRUE(all->residuals[i].outlier) << share << " seed " << seed;
      // The wrong ones gone, what is left is the adjustment of the right ones alone.
      if (clean->outlierCount() == all->outlierCount() - wrong) {
        const auto error = poseError(all->cameraFromWorld, clean->cameraFromWorld);
        for (const double e : error) EXPECT_NEAR(e, 0, 1e-8) << share << " seed " << seed;
      }
      EXPECT_LE(all->outlierCount(), wrong + 2) << share << " seed " << seed;
    }
}

}  // namespace
}  // namespace alidade
