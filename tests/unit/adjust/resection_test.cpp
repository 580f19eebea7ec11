// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <ceres/ceres.h>
#include <ceres/gradient_checker.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "adjust/pose_problem.h"
#include "adjust/start_pose.h"
#include "ceres_cost.h"
#include "sites.h"

namespace alidade {
namespace {

using testing::HasSubstr;

TEST(Resection, FindsTheExactPoseFromExactPicks) {
  const Site site = randomSite(3, 12, 0);
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary);
  ASSERT_TRUE(summary->converged) << summary->reason;
  for (const double e : poseError(summary->cameraFromWorld, site.truth)) EXPECT_NEAR(e, 0, 1e-9);
  EXPECT_LT(summary->rmsPx, 1e-7);
  EXPECT_EQ(summary->outlierCount(), 0);
}

/// Exact picks of a camera that turns and walks while its rows are read; half of them wrong, and no start pose, in the end.
TEST(Resection, PicksOfARollingShutterGiveTheMiddleRowsPose) {
  const RollingShutter shutter{0.03, {{0.3, -0.5, 0.4}, {1, -2, 0.5}}};
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Site site = randomSite(seed, 30, 0);
    for (ResectionObservation& pick : site.picks) {
      const auto seen = project(site.camera, shutter, site.truth * pick.world);
      ASSERT_TRUE(seen);
      pick.pixel = *seen;
      for (int i = 0; i < 30; ++i)
        pick.pixel = site.camera.projectUnchecked(
            exponential(shutter.motion * shutter.secsAtRow(pick.pixel.y, site.camera.height())) * (site.truth * pick.world));
    }
    ResectionOptions options;
    const auto still = resect(site.camera, site.start, site.picks, options);
    ASSERT_TRUE(still);
    EXPECT_GT(glm::length(still->cameraFromWorld.centre() - site.truth.centre()), 0.005);
    options.shutter = shutter;
    const auto found = resect(site.camera, site.start, site.picks, options);
    ASSERT_TRUE(found && found->converged) << found->reason;
    EXPECT_LT(glm::length(found->cameraFromWorld.centre() - site.truth.centre()), 1e-6);
    EXPECT_LT(rotationAngleBetween(found->cameraFromWorld, site.truth), 1e-8);
    const auto fromNothing = findStartPose(site.camera, site.picks, shutter);
    ASSERT_TRUE(fromNothing) << fromNothing.error().text();
    EXPECT_LT(glm::length(fromNothing->centre() - site.truth.centre()), 1e-6);
    for (std::size_t i = 0; i < 12; ++i) site.picks[i].pixel += glm::dvec2(40 + 9 * i, -30 - 7.0 * i * i);
    const auto robust = findStartPose(site.camera, site.picks, shutter);
    ASSERT_TRUE(robust) << robust.error().text();
    // The rows of the wrong picks are wrong as well, but they take no part.
    EXPECT_LT(glm::length(robust->centre() - site.truth.centre()), 1e-5);
  }
}

TEST(Resection, IsTheSameAtTheOriginAndTenThousandKilometresAway) {
  const glm::dvec3 far(1e7, -1e7, 1e4);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Site near = randomSite(seed, 20, 0.5);
    Site moved = near;
    for (auto& pick : moved.picks) pick.world += far;
    moved.start.translation -= moved.start.rotation * far;
    const auto here = resect(near.camera, near.start, near.picks), there = resect(moved.camera, moved.start, moved.picks);
    ASSERT_TRUE(here && there);
    ASSERT_TRUE(here->converged && there->converged);
    // A double at 10⁷ m holds 2e-9 m; the points' own rounding is a few of these.
    EXPECT_LT(glm::length(there->cameraFromWorld.centre() - far - here->cameraFromWorld.centre()), 5e-8);
    EXPECT_LT(rotationAngleBetween(here->cameraFromWorld, there->cameraFromWorld), 1e-8);
    EXPECT_NEAR(there->rmsPx, here->rmsPx, 1e-6);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(there->positionStdM[i] / here->positionStdM[i], 1, 1e-5);
  }
}

TEST(Resection, KeepsEveryLockedParameterAndSaysThatItIsCertain) {
  const Site site = randomSite(11, 20, 0.5);
  const glm::dvec3 start = site.start.centre();
  for (int locks = 1; locks < 16; ++locks) {
    ResectionOptions options;
    for (int i = 0; i < 3; ++i) options.lockPosition[i] = locks & (1 << i);
    options.lockAttitude = locks & 8;
    // The truth, seen from where the locks hold it: outliers would come from the wrong lock alone.
    std::vector<ResectionObservation> picks = site.picks;
    RigidTransform truth = turnedBy(options.lockAttitude ? site.start : site.truth, {}, {});
    glm::dvec3 centre = site.truth.centre();
    for (int i = 0; i < 3; ++i)
      if (options.lockPosition[i]) centre[i] = start[i];
    truth.translation = -(truth.rotation * centre);
    for (std::size_t i = 0; i < picks.size(); ++i) {
      const glm::dvec2 noise = site.picks[i].pixel - *site.camera.project(site.truth * site.picks[i].world);
      picks[i].pixel = *site.camera.project(truth * picks[i].world) + noise;
    }
    const auto summary = resect(site.camera, site.start, picks, options);
    ASSERT_TRUE(summary);
    if (locks == 15) {
      EXPECT_FALSE(summary->converged);
      EXPECT_THAT(summary->reason, HasSubstr("both locked"));
      continue;
    }
    ASSERT_TRUE(summary->converged) << locks << ": " << summary->reason;
    const glm::dvec3 got = summary->cameraFromWorld.centre();
    for (int i = 0; i < 3; ++i) {
      if (options.lockPosition[i]) {
        EXPECT_NEAR(got[i], start[i], 1e-12);
        EXPECT_EQ(summary->positionStdM[i], 0);
        for (int j = 0; j < 6; ++j) EXPECT_EQ(summary->covariance[i][j], 0);
      } else {
        EXPECT_GT(summary->positionStdM[i], 0);
        EXPECT_NEAR(got[i], centre[i], 5 * summary->positionStdM[i]);
      }
      if (options.lockAttitude) {
        EXPECT_EQ(summary->rotationStdRad[i], 0);
      } else {
        EXPECT_GT(summary->rotationStdRad[i], 0);
      }
    }
    if (options.lockAttitude) {
      EXPECT_LT(rotationAngleBetween(summary->cameraFromWorld, site.start), 1e-15);
    }
  }
}

TEST(Resection, EveryFreeParameterLessMakesTheOthersMoreCertain) {
  const Site site = randomSite(11, 20, 0);
  ResectionOptions locked;
  locked.lockPosition = {true, true, true};
  const auto whole = resect(site.camera, site.truth, site.picks);
  const auto attitude = resect(site.camera, site.truth, site.picks, locked);
  ASSERT_TRUE(whole && attitude);
  for (int i = 0; i < 3; ++i) EXPECT_LT(attitude->rotationStdRad[i], whole->rotationStdRad[i]);
}

TEST(Resection, StatesResidualsAsProjectedMinusObserved) {
  Site site = randomSite(5, 20, 0);
  site.picks[4].pixel += glm::dvec2(30, -40);
  site.picks[4].sigmaPx = 2;
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary && summary->converged);
  EXPECT_NEAR(summary->residuals[4].residualPx.x, -30, 1e-5);
  EXPECT_NEAR(summary->residuals[4].residualPx.y, 40, 1e-5);
  EXPECT_NEAR(summary->residuals[4].sigmas, 25, 1e-5);
  EXPECT_TRUE(summary->residuals[4].outlier);
  EXPECT_EQ(summary->outlierCount(), 1);
  EXPECT_EQ(summary->residuals[4].name, "P5");
  EXPECT_THAT(summary->report(), HasSubstr("outlier"));
  EXPECT_THAT(summary->report(), HasSubstr("Camera centre"));
}

TEST(Resection, APickFarOffIsFoundWhereItDominatesItsOwnResidual) {
  // One of five points alone in its corner of the picture has little that checks it: its raw residual is far
  // smaller than its error. The standardised residual still finds it, or refuses to say.
  Site site = randomSite(8, 9, 0.1);
  site.picks[0].pixel += glm::dvec2(4, 3);
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary && summary->converged) << summary->reason;
  EXPECT_TRUE(summary->residuals[0].outlier);
  EXPECT_EQ(summary->outlierCount(), 1);
}

TEST(Resection, WithoutARobustLossUsesEveryPick) {
  Site site = randomSite(5, 20, 0.5);
  site.picks[4].pixel += glm::dvec2(30, -40);
  ResectionOptions plain;
  plain.huberSigmas = 0;
  const auto summary = resect(site.camera, site.start, site.picks, plain);
  ASSERT_TRUE(summary && summary->converged) << summary->reason;
  EXPECT_GT(summary->sigma0, 5);
  const auto robust = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(robust && robust->converged);
  EXPECT_LT(robust->sigma0, 1.5);
}

TEST(Resection, PicksThatAreWorseThanTheirSigmasAreUsedAndTheReasonSaysSo) {
  Site site = randomSite(21, 20, 3.0);
  for (auto& pick : site.picks) pick.sigmaPx = 0.3;
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary);
  ASSERT_TRUE(summary->converged) << summary->reason;
  EXPECT_NEAR(summary->sigma0, 10, 3.5);
  EXPECT_THAT(summary->reason, HasSubstr("times the given sigmas"));
  EXPECT_EQ(summary->sigmaScale, summary->sigma0);
  // Given the sigma that the residuals show, the same picks have the same covariance.
  Site honest = site;
  for (auto& pick : honest.picks) pick.sigmaPx = 0.3 * summary->sigma0;
  ResectionOptions at;
  at.at = {site.truth.inverse() * glm::dvec3(0, 0, 23)};
  const auto scaled = resect(site.camera, site.start, site.picks, at), told = resect(site.camera, site.start, honest.picks, at);
  ASSERT_TRUE(scaled && told && scaled->converged && told->converged);
  EXPECT_EQ(told->sigmaScale, 1);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(scaled->covariance[i][i] / told->covariance[i][i], 1, 1e-3);
  // What was estimated is known less well than what was given: F(2, 34) = 3.276 for F(2, infinity) = 2.996, by the tables.
  const double wider = std::sqrt(3.276 / 2.996);
  EXPECT_NEAR(scaled->ellipse.semiMajorM / told->ellipse.semiMajorM, wider, 1e-3);
  EXPECT_NEAR(scaled->expected[0].millimetres / told->expected[0].millimetres, wider, 1e-3);
}

TEST(Resection, OnePickUnderTwoNamesIsSaid) {
  Site site = randomSite(4, 12, 0.5);
  const auto once = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(once && once->converged);
  EXPECT_TRUE(once->warnings.empty());
  site.picks.push_back(site.picks[3]);
  site.picks.back().name = "again";
  const auto twice = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(twice && twice->converged);
  EXPECT_THAT(twice->report(), HasSubstr("1 observation has the pixel and the point of another and counts twice (\"P4\" and \"again\" first)"));
}

TEST(Resection, APointBehindTheCameraIsCalledSo) {
  Site site = randomSite(2, 20, 0.5);
  site.picks[7].world = site.truth.inverse() * glm::dvec3(1, 1, -5);
  const auto summary = resect(site.camera, site.start, site.picks);
  ASSERT_TRUE(summary && summary->converged);
  EXPECT_THAT(summary->report(), HasSubstr("behind the camera  outlier"));
  EXPECT_THAT(summary->report(), testing::Not(HasSubstr("nan")));
}

TEST(Resection, ExpectedMillimetresAreTheEllipseAtThePointsDepth) {
  // On the axis of an undistorted camera the major axis in pixels is z/f metres a pixel wide.
  Site site = randomSite(2, 20, 0.5);
  site.camera = Camera(Intrinsics::fromParameters(CameraModel::Pinhole, 1920, 1080, {1150, 1150, 960, 540}).value());
  for (auto& pick : site.picks) pick.pixel = *site.camera.project(site.truth * pick.world);
  ResectionOptions options;
  options.at = {site.truth.inverse() * glm::dvec3(0, 0, 23), site.truth.inverse() * glm::dvec3(0, 0, -5)};
  const auto summary = resect(site.camera, site.start, site.picks, options);
  ASSERT_TRUE(summary && summary->converged);
  const ExpectedError& e = summary->expected[0];
  EXPECT_GT(e.ellipseSemiMajorPx, e.ellipseSemiMinorPx);
  EXPECT_NEAR(e.millimetres / (1000 * e.ellipseSemiMajorPx * 23 / 1150), 1, 1e-6);
  EXPECT_TRUE(std::isnan(summary->expected[1].millimetres)) << "behind the camera";
}

TEST(Resection, RefusesBadOptionsAsAnError) {
  const Site site = randomSite(1, 8, 0.5);
  const auto withOptions = [&](auto change) {
    ResectionOptions options;
    change(options);
    return resect(site.camera, site.start, site.picks, options).has_value();
  };
  EXPECT_TRUE(withOptions([](auto&) {}));
  EXPECT_FALSE(withOptions([](auto& o) { o.huberSigmas = -1; }));
  EXPECT_FALSE(withOptions([](auto& o) { o.huberSigmas = std::nan(""); }));
  EXPECT_FALSE(withOptions([](auto& o) { o.outlierSigmas = 0; }));
  EXPECT_FALSE(withOptions([](auto& o) { o.maximumIterations = 0; }));
  EXPECT_FALSE(withOptions([](auto& o) { o.at = {{1, std::nan(""), 2}}; }));
}

TEST(Derivatives, OfTheSolversCostPassCeresGradientCheck) {
  const Site site = randomSite(4, 30, 0.5);
  ceres::QuaternionManifold quaternion;
  std::vector<const ceres::Manifold*> manifolds{nullptr, &quaternion};
  ceres::NumericDiffOptions steps;
  steps.ridders_relative_initial_step_size = 1e-4;
  const glm::dvec3 origin = site.start.centre();
  for (const ResectionObservation& pick : site.picks) {
    const ceres::AutoDiffCostFunction<ReprojectionCost, 2, 3, 4> cost(
        new ReprojectionCost{&site.camera, pick.pixel, pick.world - origin, pick.sigmaPx});
    const double centre[3] = {0.1, -0.2, 0.05};
    const glm::dquat& q = site.start.rotation;
    const double rotation[4] = {q.w, q.x, q.y, q.z};
    const double* parameters[2] = {centre, rotation};
    ceres::GradientChecker checker(&cost, &manifolds, steps);
    ceres::GradientChecker::ProbeResults probe;
    EXPECT_TRUE(checker.Probe(parameters, 1e-6, &probe)) << probe.error_log;
  }
}

TEST(Derivatives, OfTheNormalEquationsEqualDifferencesOfTheProjection) {
  const Site site = randomSite(4, 30, 0.5, {1e5, 2e5, 30});
  const ResectionOptions options;
  const PoseProblem problem(site.camera, site.start, site.picks, options);
  const PoseState state = problem.startState();
  for (int i = 0; i < problem.size(); ++i) {
    const auto at = problem.linearise(state, i);
    ASSERT_TRUE(at);
    for (int c = 0; c < 6; ++c) {
      const double h = 1e-4;
      const auto shifted = [&](double step) {
        glm::dvec3 shift(0), turn(0);
        (c < 3 ? shift : turn)[c % 3] = step;
        PoseState moved = state;
        moved.centre += shift;
        if (c >= 3) moved.rotation = glm::angleAxis(step, glm::normalize(turn / step)) * state.rotation;
        return site.camera.projectUnchecked(problem.inCamera(moved, site.picks[i].world));
      };
      const glm::dvec2 slope = (shifted(h) - shifted(-h)) / (2 * h);
      EXPECT_NEAR(at->jacobian(0, c), slope.x, 1e-4 * (1 + std::abs(slope.x)));
      EXPECT_NEAR(at->jacobian(1, c), slope.y, 1e-4 * (1 + std::abs(slope.y)));
    }
  }
}

}  // namespace
}  // namespace alidade
