// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The figures an adjustment stands on, over 2000 seeded scenes each: against the Cramér-Rao bound, against OpenCV's
// refinement, ellipses against truth, half of the picks wrong. Prints what it finds.

#include <cmath>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "network_sites.h"
#include "opencv_peer.h"

namespace alidade {
namespace {

constexpr unsigned scenes = 2000;

struct Squares {
  double position = 0, rotation = 0;
  void add(const std::array<double, 6>& e) {
    position += e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    rotation += e[3] * e[3] + e[4] * e[4] + e[5] * e[5];
  }
};

bool holds(const PositionEllipse& e, const std::array<double, 6>& error) {
  const double s = std::sin(e.azimuthRad), c = std::cos(e.azimuthRad);
  const double along = (s * error[0] + c * error[1]) / e.semiMajorM, across = (c * error[0] - s * error[1]) / e.semiMinorM;
  return along * along + across * across <= 1;
}

/// Trace of the inverse Fisher information of the picks at the true pose, by differences of the camera's own projection.
std::array<double, 2> cramerRao(const Site& site) {
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  for (const ResectionObservation& pick : site.picks) {
    Eigen::Matrix<double, 2, 6> jacobian;
    for (int c = 0; c < 6; ++c) {
      const double h = 1e-5;
      glm::dvec3 shift(0), turn(0);
      (c < 3 ? shift : turn)[c % 3] = h;
      const glm::dvec2 up = *site.camera.project(turnedBy(site.truth, turn, shift) * pick.world);
      const glm::dvec2 down = *site.camera.project(turnedBy(site.truth, -turn, -shift) * pick.world);
      jacobian.col(c) << (up.x - down.x) / (2 * h), (up.y - down.y) / (2 * h);
    }
    information += jacobian.transpose() * jacobian / (pick.sigmaPx * pick.sigmaPx);
  }
  const Eigen::Matrix<double, 6, 6> bound = information.inverse();
  return {bound.topLeftCorner<3, 3>().trace(), bound.bottomRightCorner<3, 3>().trace()};
}

TEST(SlowStatistics, TwoThousandScenesReachTheCramerRaoBoundAndOpenCv) {
  Squares ours, theirs;
  double boundPosition = 0, boundRotation = 0;
  int held = 0, heldHeight = 0, worse = 0;
  for (unsigned seed = 1; seed <= scenes; ++seed) {
    const Site site = randomSite(seed, 20, 0.5);
    const auto summary = resect(site.camera, site.start, site.picks);
    ASSERT_TRUE(summary && summary->converged) << seed << ": " << summary->reason;
    const auto error = poseError(summary->cameraFromWorld, site.truth), peer = poseError(refinedByOpenCv(site), site.truth);
    ours.add(error), theirs.add(peer);
    Squares one, other;
    one.add(error), other.add(peer);
    worse += std::sqrt(one.position) > 1.0001 * std::sqrt(other.position) + 1e-9;
    const auto bound = cramerRao(site);
    boundPosition += bound[0], boundRotation += bound[1];
    held += holds(summary->ellipse, error);
    heldHeight += std::abs(error[2]) <= summary->ellipse.heightM;
  }
  const double position = std::sqrt(ours.position / boundPosition), rotation = std::sqrt(ours.rotation / boundRotation);
  std::printf("2000 scenes: rms error / Cramer-Rao bound %.4f position, %.4f attitude; / OpenCV's %.6f, %.6f; scenes "
              "farther off than OpenCV's %d; ellipses hold %.2f %%, heights %.2f %%\n",
              position, rotation, std::sqrt(ours.position / theirs.position), std::sqrt(ours.rotation / theirs.rotation), worse,
              100.0 * held / scenes, 100.0 * heldHeight / scenes);
  EXPECT_LE(position, 1.05);
  EXPECT_LE(rotation, 1.05);
  EXPECT_LE(ours.position, theirs.position * (1 + 1e-6));
  EXPECT_LE(ours.rotation, theirs.rotation * (1 + 1e-6));
  EXPECT_GE(held, 0.93 * scenes);
  EXPECT_LE(held, 0.97 * scenes);
  EXPECT_GE(heldHeight, 0.93 * scenes);
  EXPECT_LE(heldHeight, 0.97 * scenes);
}

TEST(SlowStatistics, HalfOfThePicksWrongCostsAtMostAThird) {
  constexpr unsigned trials = 1000;
  int within = 0, refused = 0;
  for (unsigned seed = 1; seed <= trials; ++seed) {
    Site site = randomSite(seed, 40, 0.5);
    std::mt19937_64 random(seed + 1000);
    std::uniform_real_distribution<double> unit(0, 1);
    const std::vector<ResectionObservation> right(site.picks.begin() + 20, site.picks.end());
    for (int i = 0; i < 20; ++i) {
      const double angle = 6.283185307 * unit(random), far = 10 * std::pow(60.0, unit(random));
      site.picks[i].pixel += far * glm::dvec2(std::cos(angle), std::sin(angle));
    }
    const auto all = resect(site.camera, site.start, site.picks), clean = resect(site.camera, site.start, right);
    ASSERT_TRUE(all && clean && clean->converged);
    refused += !all->converged;
    Squares ours, theirs;
    ours.add(poseError(all->cameraFromWorld, site.truth)), theirs.add(poseError(clean->cameraFromWorld, site.truth));
    within += all->converged && std::sqrt(ours.position) <= 1.3 * std::sqrt(theirs.position) &&
              std::sqrt(ours.rotation) <= 1.3 * std::sqrt(theirs.rotation);
  }
  std::printf("half of 40 picks 10 to 600 px off, %u trials: %.2f %% within 1.3 times the error without them, %d refused\n",
              trials, 100.0 * within / trials, refused);
  EXPECT_GE(within, 0.99 * trials);
}

TEST(SlowStatistics, EllipsesOfABundlesPosesHoldTheTruth) {
  constexpr unsigned trials = 300;
  int held = 0, poses = 0;
  double nees = 0;
  for (unsigned seed = 1; seed <= trials; ++seed) {
    NetworkSiteOptions options;
    options.seed = seed, options.controls = 8, options.ties = 40, options.controlSigmaM = 0.01;
    const NetworkSite site = arcSite(options);
    const auto summary = adjustNetwork(site.network);
    ASSERT_TRUE(summary && summary->converged) << seed;
    for (std::size_t i = 0; i < site.poses.size(); ++i) {
      const AdjustedPose& pose = summary->poses[i];
      const auto error = poseError(pose.bodyFromWorld, site.poses[i]);
      held += holds(pose.ellipse, error);
      ++poses;
      Eigen::Matrix<double, 6, 6> covariance;
      Eigen::Matrix<double, 6, 1> e;
      for (int r = 0; r < 6; ++r) {
        e[r] = error[r];
        for (int k = 0; k < 6; ++k) covariance(r, k) = pose.covariance[r][k];
      }
      nees += e.dot(covariance.ldlt().solve(e));
    }
  }
  std::printf("bundles of 6 frames, 8 control points of 10 mm, 40 tie points, %u trials: ellipses hold %.2f %% of %d poses, "
              "normalised squared error %.3f of 6\n", trials, 100.0 * held / poses, poses, nees / poses);
  EXPECT_GE(held, 0.93 * poses);
  EXPECT_LE(held, 0.97 * poses);
}

/// Sigmas too small by five: the residuals say so, and the ellipses grow with them.
TEST(SlowStatistics, EllipsesHoldTheTruthWhereTheSigmasWereTooSmall) {
  int held = 0, heldOfFew = 0, scaled = 0, scaledOfFew = 0, few = 0, heldInBundles = 0, scaledBundles = 0, poses = 0;
  for (unsigned seed = 1; seed <= scenes; ++seed) {
    Site site = randomSite(seed, 40, 0.5);
    for (ResectionObservation& pick : site.picks) pick.sigmaPx = 0.1;
    const auto summary = resect(site.camera, site.start, site.picks);
    ASSERT_TRUE(summary && summary->converged) << seed << ": " << summary->reason;
    scaled += summary->sigmaScale > 1;
    held += holds(summary->ellipse, poseError(summary->cameraFromWorld, site.truth));

    Site small = randomSite(seed, 10, 0.5);
    for (ResectionObservation& pick : small.picks) pick.sigmaPx = 0.1;
    const auto ofFew = resect(small.camera, small.start, small.picks);
    if (!ofFew->converged) continue;
    ++few;
    scaledOfFew += ofFew->sigmaScale > 1;
    heldOfFew += holds(ofFew->ellipse, poseError(ofFew->cameraFromWorld, small.truth));
  }
  constexpr unsigned trials = 300;
  for (unsigned seed = 1; seed <= trials; ++seed) {
    NetworkSiteOptions options;
    options.seed = seed, options.controls = 8, options.ties = 40, options.controlSigmaM = 0.01;
    NetworkSite site = arcSite(options);
    for (PictureObservation& o : site.network.observations) o.sigmaPx /= 5;
    for (NetworkPoint& p : site.network.points) p.sigmaM /= 5.0;
    const auto summary = adjustNetwork(site.network);
    ASSERT_TRUE(summary && summary->converged) << seed;
    scaledBundles += summary->sigmaScale > 1;
    for (std::size_t i = 0; i < site.poses.size(); ++i, ++poses)
      heldInBundles += holds(summary->poses[i].ellipse, poseError(summary->poses[i].bodyFromWorld, site.poses[i]));
  }
  std::printf("sigmas five times too small: %d of %u scenes of 40 picks, %d of %d of 10 and %d of %u bundles scaled by sigma naught; ellipses hold "
              "%.2f %%, %.2f %%, of %d poses in bundles %.2f %%\n", scaled, scenes, scaledOfFew, few, scaledBundles, trials, 100.0 * held / scenes,
              100.0 * heldOfFew / few, poses, 100.0 * heldInBundles / poses);
  EXPECT_GE(held, 0.93 * scenes);
  EXPECT_LE(held, 0.97 * scenes);
  EXPECT_GE(few, 0.99 * scenes);
  EXPECT_GE(heldOfFew, 0.93 * few);
  EXPECT_LE(heldOfFew, 0.97 * few);
  EXPECT_GE(heldInBundles, 0.93 * poses);
  EXPECT_LE(heldInBundles, 0.97 * poses);
}

}  // namespace
}  // namespace alidade
