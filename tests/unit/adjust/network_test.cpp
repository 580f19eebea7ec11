// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The network adjustment against known truth and against Ceres on the same problem.

#include <ceres/ceres.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "adjust/network_checks.h"
#include "ceres_cost.h"
#include "network_sites.h"

namespace alidade {
namespace {

using testing::HasSubstr;

NetworkSummary adjusted(const Network& network, const NetworkOptions& options = {}) {
  const auto summary = adjustNetwork(network, options);
  EXPECT_TRUE(summary) << (summary ? "" : summary.error().text());
  return summary ? *summary : NetworkSummary{};
}

/// Longest error of a centre and largest of an attitude.
std::pair<double, double> worstPose(const NetworkSite& site, const NetworkSummary& summary) {
  double shift = 0, turn = 0;
  for (std::size_t i = 0; i < site.poses.size(); ++i) {
    const RigidTransform& got = summary.poses[i].bodyFromWorld;
    shift = std::max(shift, glm::length(got.centre() - site.poses[i].centre()));
    turn = std::max(turn, rotationAngleBetween(got, site.poses[i]));
  }
  return {shift, turn};
}

TEST(Network, FindsTheExactPosesAndPointsFromExactPicks) {
  NetworkSiteOptions options;
  options.noisePx = 0;
  const NetworkSite site = arcSite(options);
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  const auto [shift, turn] = worstPose(site, summary);
  EXPECT_LT(shift, 1e-7);
  EXPECT_LT(turn, 1e-8);
  for (std::size_t i = 0; i < site.points.size(); ++i) EXPECT_LT(glm::length(summary.points[i] - site.points[i]), 1e-6);
  EXPECT_EQ(summary.outlierCount(), 0);
}

/// The rows are looked up again and again with the true motion: exact picks of a camera that turns and walks.
TEST(Network, PicksOfARollingShutterGiveTheMiddleRowsPose) {
  NetworkSite site = arcSite({.noisePx = 0});
  const Camera camera(site.network.cameras[0].intrinsics);
  const RollingShutter shutter{0.03, {{0.3, -0.5, 0.4}, {1, -2, 0.5}}};
  for (PictureObservation& seen : site.network.observations) {
    const glm::dvec3 inCamera = site.poses[seen.frame] * site.points[seen.point];
    for (int i = 0; i < 30; ++i)
      seen.pixel = camera.projectUnchecked(exponential(shutter.motion * shutter.secsAtRow(seen.pixel.y, camera.height())) * inCamera);
  }
  const auto worstOf = [&](const RollingShutter& taken) {
    for (NetworkFrame& frame : site.network.frames) frame.shutter = taken;
    const auto summary = adjustNetwork(site.network);
    EXPECT_TRUE(summary) << summary.error().text();
    double worst = 0;
    for (std::size_t i = 0; summary && i < site.poses.size(); ++i)
      worst = std::max(worst, glm::length(summary->poses[i].bodyFromWorld.centre() - site.poses[i].centre()));
    return worst;
  };
  EXPECT_LT(worstOf(shutter), 1e-6);
  EXPECT_GT(worstOf({}), 0.005);
}

/// The depth of a picked point is that of its row's camera; of another point that of the middle row's.
TEST(Network, DepthsOfARollingShutterFollowTheirPicksRows) {
  NetworkSite site = arcSite({.noisePx = 0});
  Network& n = site.network;
  const Camera camera(n.cameras[0].intrinsics);
  const RollingShutter shutter{0.03, {{0.3, -0.5, 0.4}, {1, -2, 4}}};
  for (NetworkFrame& frame : n.frames) frame.shutter = shutter;
  for (PictureObservation& seen : n.observations) {
    const glm::dvec3 inCamera = site.poses[seen.frame] * site.points[seen.point];
    glm::dvec3 atRow = inCamera;
    for (int i = 0; i < 30; ++i) {
      seen.pixel = camera.projectUnchecked(atRow);
      atRow = exponential(shutter.motion * shutter.secsAtRow(seen.pixel.y, camera.height())) * inCamera;
    }
    if (seen.frame < 2) n.depths.push_back({seen.frame, seen.point, atRow.z, 0.01});
  }
  const NetworkSummary summary = adjusted(n);
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_LT(worstPose(site, summary).first, 1e-6);
  const auto group = std::find_if(summary.groups.begin(), summary.groups.end(), [](const ResidualGroup& g) { return g.kind == ResidualKind::Depth; });
  ASSERT_NE(group, summary.groups.end());
  EXPECT_LT(group->rmsM, 1e-6);
  for (NetworkFrame& frame : n.frames) frame.shutter.motion.translation.z = 0;
  const NetworkSummary standing = adjusted(n);
  EXPECT_GT(worstPose(site, standing).first, 1e-3);
}

/// A step that is damped enough promises next to nothing anywhere: only where the undamped one does, too, is it a minimum.
TEST(Network, ConvergedMeansThatTheUndampedStepIsNothing) {
  int converged = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const double far = 0.05 + 0.015 * seed;
    NetworkSite site = arcSite({.ties = 20, .startShiftM = 8 * far, .startTurnRad = far, .seed = seed});
    site.network.cameras[0].freeFocal = site.network.cameras[0].freeDistortion = true;
    const NetworkLayout layout(site.network);
    const NetworkTerms terms(site.network, layout);
    std::vector<std::string> warnings;
    const auto start = startState(site.network, layout, warnings);
    if (!start || !warnings.empty()) continue;
    NormalSystem normals(terms);
    std::vector<char> active(terms.terms().size(), 1);
    const std::vector<double> sigmas = termSigmas(terms, *start);
    for (std::size_t t = 0; t < active.size(); ++t) active[t] = std::isfinite(sigmas[t]);
    normals.use(active);
    const NetworkFit fit = fitNetwork(terms, normals, active, *start, 0, 400, {});
    if (!fit.converged) continue;
    ++converged;
    ASSERT_TRUE(normals.linearise(fit.state, 0));
    if (!normals.solve(1e-10)) continue;
    EXPECT_LT(normals.promisedDecrease(), 1e-8 * fit.cost + 1e-4) << seed;
  }
  EXPECT_GT(converged, 10);
}

TEST(Network, IsTheSameTenThousandKilometresAway) {
  NetworkSiteOptions here, there;
  there.where = {1e7, -1e7, 1e4};
  const NetworkSummary a = adjusted(arcSite(here).network), b = adjusted(arcSite(there).network);
  ASSERT_TRUE(a.converged && b.converged);
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_LT(glm::length(b.poses[i].bodyFromWorld.centre() - there.where - a.poses[i].bodyFromWorld.centre()), 1e-7);
    EXPECT_NEAR(b.poses[i].positionStdM.x / a.poses[i].positionStdM.x, 1, 1e-4);
  }
  EXPECT_NEAR(b.finalCost / a.finalCost, 1, 1e-6);
}

TEST(Network, EqualsCeresOnTheSameBundle) {
  NetworkSiteOptions options;
  options.ties = 150;
  const NetworkSite site = arcSite(options);
  NetworkOptions plain;
  plain.huberSigmas = 0;
  const NetworkSummary ours = adjusted(site.network, plain);
  ASSERT_TRUE(ours.converged) << ours.reason;

  const Camera camera(site.network.cameras[0].intrinsics);
  std::vector<std::array<double, 3>> centres, points;
  std::vector<std::array<double, 4>> rotations;
  for (const RigidTransform& pose : site.poses) {
    const glm::dvec3 c = pose.centre();
    centres.push_back({c.x, c.y, c.z});
    rotations.push_back({pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z});
  }
  for (const glm::dvec3& p : site.points) points.push_back({p.x, p.y, p.z});
  ceres::Problem problem;
  for (auto& r : rotations) problem.AddParameterBlock(r.data(), 4, new ceres::QuaternionManifold);
  for (const PictureObservation& o : site.network.observations)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ReprojectionCost, 2, 3, 4, 3>(
                                 new ReprojectionCost{&camera, o.pixel, {}, o.sigmaPx}),
                             nullptr, centres[o.frame].data(), rotations[o.frame].data(), points[o.point].data());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (site.network.points[i].kind == PointKind::Control) problem.SetParameterBlockConstant(points[i].data());
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.function_tolerance = 1e-14;
  solver.max_num_iterations = 200;
  ceres::Solver::Summary theirs;
  ceres::Solve(solver, &problem, &theirs);
  EXPECT_NEAR(ours.finalCost / theirs.final_cost, 1, 1e-8);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const glm::dvec3 c = ours.poses[i].bodyFromWorld.centre();
    EXPECT_LT(glm::length(c - glm::dvec3(centres[i][0], centres[i][1], centres[i][2])), 1e-6);
  }
  // The standard deviations against Ceres' own covariance.
  ceres::Covariance covariance(ceres::Covariance::Options{});
  std::vector<std::pair<const double*, const double*>> wanted{{centres[2].data(), centres[2].data()}};
  ASSERT_TRUE(covariance.Compute(wanted, &problem));
  double block[9];
  covariance.GetCovarianceBlock(centres[2].data(), centres[2].data(), block);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(ours.poses[2].positionStdM[k] / std::sqrt(block[4 * k]), 1, 1e-4);
}

TEST(Network, TellsOutliersFromTheRest) {
  NetworkSite site = arcSite();
  std::mt19937_64 random(5);
  std::vector<std::size_t> wrong;
  for (std::size_t i = 3; i < site.network.observations.size(); i += 17) {
    site.network.observations[i].pixel += glm::dvec2(15 + random() % 60, -20.0);
    wrong.push_back(i);
  }
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  for (const std::size_t i : wrong) EXPECT_TRUE(summary.residuals[i].outlier) << i;
  EXPECT_LE(summary.outlierCount(), static_cast<int>(wrong.size()) + 1);
  EXPECT_NEAR(summary.sigma0, 1, 0.15);
  for (std::size_t i = 0; i < site.poses.size(); ++i) {
    const auto error = poseError(summary.poses[i].bodyFromWorld, site.poses[i]);
    for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(error[k]), 4.5 * summary.poses[i].positionStdM[k]) << i;
  }
}

TEST(Network, AFrameWithoutPoseIsFoundFromItsKnownPoints) {
  NetworkSite site = arcSite();
  for (NetworkPose& pose : site.network.poses) pose.bodyFromWorld.reset();
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_LT(worstPose(site, summary).first, 0.05);
  // With three known points left there is nothing to find it from.
  std::erase_if(site.network.observations, [](const auto& o) { return o.frame == 2 && o.point >= 3 && o.point < 6; });
  const auto none = adjustNetwork(site.network);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text(), HasSubstr("frame \"F3\" has no pose to start from"));
}

TEST(Network, ControlWithAStandardDeviationMovesByIt) {
  NetworkSiteOptions options;
  options.controlSigmaM = 0.05, options.controls = 12;
  const NetworkSite site = arcSite(options);
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  for (int i = 0; i < 12; ++i) {
    EXPECT_GT(glm::length(summary.points[i] - *site.network.points[i].world), 1e-4);
    EXPECT_LT(glm::length(summary.points[i] - *site.network.points[i].world), 0.3);
  }
  EXPECT_NEAR(summary.sigma0, 1, 0.15);
}

TEST(Network, EdgesOfThreeDirectionsGiveThePoseAndFewerAreRefused) {
  const NetworkSite site = arcSite({.frames = 1, .ties = 0, .controls = 0});
  const Camera camera(site.network.cameras[0].intrinsics);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  const auto withEdges = [&](int directions) {
    Network n = site.network;
    for (int k = 0; k < 12; ++k) {
      const glm::dvec3 along = k % directions == 0 ? glm::dvec3(0, 0, 1) : k % directions == 1 ? glm::dvec3(1, 0, 0) : glm::dvec3(0.2, 1, 0.1);
      const glm::dvec3 from(-6 + 1.1 * k, (k * 5) % 7 - 3.0, (k * 3) % 5 - 0.5), to = from + 3.0 * along;
      for (const double s : {0.05, 0.35, 0.65, 0.95})
        n.edges.push_back({0, from, to, *camera.project(site.poses[0] * (from + s * (to - from))) + 0.2 * glm::dvec2(normal(random), normal(random)),
                           0.2, false, fmt::format("edge {}", k + 1)});
    }
    return n;
  };
  const NetworkSummary three = adjusted(withEdges(3));
  ASSERT_TRUE(three.converged) << three.reason;
  const auto error = poseError(three.poses[0].bodyFromWorld, site.poses[0]);
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(error[i]), 4.5 * three.poses[0].positionStdM[i]) << i;
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(error[3 + i]), 4.5 * three.poses[0].rotationStdRad[i]) << i;
  EXPECT_NEAR(three.sigma0, 1, 0.35);
  const NetworkSummary two = adjusted(withEdges(2));
  EXPECT_FALSE(two.converged);
  EXPECT_THAT(two.reason, HasSubstr("fewer than three directions"));
}

TEST(Network, TiesOnAScannedSurfaceAndWithDepthHoldTheScale) {
  // Two frames, the first known, tie points alone: scale is open until depths or surfaces give it.
  NetworkSiteOptions options;
  options.frames = 2, options.controls = 0, options.ties = 40;
  NetworkSite site = arcSite(options);
  site.network.poses[0].bodyFromWorld = site.poses[0];
  site.network.poses[0].locked.fill(true);
  const NetworkSummary open = adjusted(site.network);
  EXPECT_FALSE(open.converged);
  EXPECT_THAT(open.reason, testing::AnyOf(HasSubstr("singular"), HasSubstr("undetermined")));
  Network depths = site.network, surfaces = site.network;
  for (int p = 0; p < 20; ++p) {
    depths.depths.push_back({0, p, (site.poses[0] * site.points[p]).z, 0.01, false});
    surfaces.points[p].surface = SurfaceHold{site.points[p], {0.3, -1, 0.2}, 0.005};
  }
  for (const Network& held : {depths, surfaces}) {
    const NetworkSummary summary = adjusted(held);
    ASSERT_TRUE(summary.converged) << summary.reason;
    EXPECT_LT(glm::length(summary.poses[1].bodyFromWorld.centre() - site.poses[1].centre()), 0.05);
  }
}

TEST(Network, PriorsCarryAFrameThatSeesTooLittle) {
  NetworkSite site = arcSite({.frames = 3, .ties = 0, .controls = 2});
  PosePrior prior;
  for (int i = 0; i < 6; ++i) prior.covariance[i][i] = i < 3 ? 1e-4 : 1e-6;
  for (int f = 0; f < 3; ++f) {
    prior.pose = f;
    prior.bodyFromWorld = site.poses[f];
    site.network.priors.push_back(prior);
  }
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_LT(worstPose(site, summary).first, 0.05);
  for (const AdjustedPose& pose : summary.poses) EXPECT_LT(pose.positionStdM.x, 0.0101);
}

TEST(Network, FindsTheClockOffsetAndTheMountOfARig) {
  // A sensor's trajectory on a clock 0.2 s off, a camera 0.3 m beside the sensor and turned by some degrees.
  const RigidTransform cameraFromBody{glm::normalize(glm::dquat(1, 0.03, -0.02, 0.05)), {0.3, -0.1, 0.05}};
  NetworkSiteOptions options;
  options.frames = 6, options.controls = 14, options.ties = 0;
  NetworkSite site = arcSite(options);
  Network& n = site.network;
  NetworkTrajectory way;
  std::vector<RigidTransform> bodies;
  for (const RigidTransform& camera : site.poses) bodies.push_back(cameraFromBody.inverse() * camera);
  for (int i = 0; i < 6; ++i) {
    way.timeSecs.push_back(0.5 * i + 0.2);
    way.bodyFromWorld.push_back(bodies[i]);
    way.poses.push_back(i);
    n.poses[i].bodyFromWorld = turnedBy(bodies[i], {0.01, -0.01, 0.005}, {0.1, -0.05, 0.05});
    n.frames[i].mount = 0;
  }
  way.clockFree = true, way.positionSigmaM = 0.005, way.attitudeSigmaRad = 5e-4;
  n.trajectories.push_back(way);
  n.mounts.push_back({"rig", RigidTransform{glm::dquat(1, 0, 0, 0), {0.2, 0, 0}}, {}});
  const NetworkSummary summary = adjusted(n);
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_NEAR(summary.clockOffsetSecs[0], 0.2, 0.003);
  EXPECT_GT(summary.clockStdSecs[0], 0);
  EXPECT_LT(glm::length(summary.cameraFromBody[0].translation - cameraFromBody.translation), 0.03);
  EXPECT_LT(rotationAngleBetween(summary.cameraFromBody[0], cameraFromBody), 2e-3);
  for (int i = 0; i < 6; ++i)
    EXPECT_LT(glm::length(cameraFromWorld(n, summary, i).centre() - site.poses[i].centre()), 0.02);
}

TEST(Network, SmoothnessHoldsAFrameThatSeesNothingBetweenTwoThatDo) {
  NetworkSite site = arcSite({.frames = 5, .ties = 0, .controls = 10});
  std::erase_if(site.network.observations, [](const auto& o) { return o.frame == 2; });
  site.network.smoothness.push_back({{0, 1, 2, 3, 4}, 0.5, 0.05});
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_LT(glm::length(summary.poses[2].bodyFromWorld.centre() - site.poses[2].centre()), 4 * glm::length(summary.poses[2].positionStdM));
  EXPECT_GT(glm::length(summary.poses[2].positionStdM), glm::length(summary.poses[1].positionStdM));
}

TEST(Network, CalibratesWhatIsFreeAndKeepsWhatIsLocked) {
  NetworkSiteOptions options;
  options.controls = 40, options.ties = 100;
  NetworkSite site = arcSite(options);
  Intrinsics& in = site.network.cameras[0].intrinsics;
  const Intrinsics truth = in;
  in.fx += 15, in.fy += 12, in.distortion.k[0] += 0.02;
  const NetworkSummary locked = adjusted(site.network);
  EXPECT_EQ(locked.cameras[0].fx, in.fx);
  site.network.cameras[0].freeFocal = site.network.cameras[0].freeDistortion = true;
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  // Focal length and k1..k3 make up for one another: what counts is where the rays go.
  const Camera before(in), after(summary.cameras[0]), right(truth);
  double off = 0, first = 0;
  for (const PictureObservation& o : site.network.observations) {
    const glm::dvec3 ray = *right.unproject(o.pixel);
    const glm::dvec2 d = *after.project(ray) - o.pixel;
    off += glm::dot(d, d) / static_cast<double>(site.network.observations.size());
    first = std::max(first, glm::length(*before.project(ray) - o.pixel));
  }
  EXPECT_GT(first, 5);
  EXPECT_LT(std::sqrt(off), 0.5);
  EXPECT_EQ(summary.cameras[0].cx, truth.cx);
  EXPECT_FALSE(summary.correlations.empty()) << "k1, k2 and k3 of one lens are always correlated";
}

TEST(Network, HeldOutPointsAreReportedBesideTheFitted) {
  NetworkSite site = arcSite({.controls = 12});
  for (PictureObservation& o : site.network.observations)
    if (o.point < 4) o.heldOut = true;
  const NetworkSummary summary = adjusted(site.network);
  ASSERT_TRUE(summary.converged) << summary.reason;
  ASSERT_EQ(summary.checkPoints.size(), 4u);
  for (const CheckPoint& c : summary.checkPoints) {
    EXPECT_GT(glm::length(c.differenceM), 0);
    EXPECT_LT(glm::length(c.differenceM), 0.05);
  }
  const auto held = std::find_if(summary.groups.begin(), summary.groups.end(), [](const auto& g) { return g.heldOut; });
  ASSERT_NE(held, summary.groups.end());
  EXPECT_NEAR(held->rmsPx, 0.7, 0.4);
  EXPECT_THAT(summary.report(site.network), HasSubstr("held out"));
  EXPECT_THAT(summary.report(site.network), HasSubstr("Check point"));
}

TEST(Network, OneFrameOfControlGivesTheResectionsPoseAndMillimetres) {
  const Site single = randomSite(7, 20, 0.5);
  Network n;
  n.poses.push_back({"P", single.start, {}, 0});
  n.cameras.push_back({"camera", single.camera.intrinsics(), false, false, false});
  n.frames.push_back({"F", 0, 0, -1, 1920, 1080});
  for (const ResectionObservation& pick : single.picks) {
    n.observations.push_back({0, static_cast<int>(n.points.size()), pick.pixel, pick.sigmaPx, false});
    n.points.push_back({pick.name, PointKind::Control, pick.world, {}, {}});
  }
  const glm::dvec3 at = single.truth.inverse() * glm::dvec3(2, 1, 15);
  NetworkOptions options;
  options.at = {{0, at}};
  ResectionOptions one;
  one.at = {at};
  const NetworkSummary network = adjusted(n, options);
  const auto resection = resect(single.camera, single.start, single.picks, one);
  ASSERT_TRUE(network.converged && resection && resection->converged);
  for (const double e : poseError(network.poses[0].bodyFromWorld, resection->cameraFromWorld)) EXPECT_NEAR(e, 0, 1e-6);
  for (int r = 0; r < 6; ++r)
    EXPECT_NEAR(network.poses[0].covariance[r][r] / resection->covariance[r][r], 1, 1e-3);
  EXPECT_NEAR(network.expected[0].millimetres / resection->expected[0].millimetres, 1, 1e-3);
  EXPECT_NEAR(network.poses[0].ellipse.semiMajorM / resection->ellipse.semiMajorM, 1, 1e-3);
}

TEST(Network, TellsOnePickUnderTwoNamesAndAPointBehindTheCamera) {
  NetworkSite site = arcSite({.controls = 12});
  Network& n = site.network;
  PictureObservation again = n.observations[0];
  for (const PictureObservation& o : n.observations)
    if (o.frame == 0 && n.points[o.point].kind == PointKind::Control) again = o;
  NetworkPoint twin = n.points[again.point];
  twin.name = "twin";
  again.point = static_cast<int>(n.points.size());
  n.points.push_back(twin);
  n.observations.push_back(again);
  NetworkPoint behind = twin;
  behind.name = "behind", behind.world = site.poses[0].inverse() * glm::dvec3(1, 1, -5);
  n.observations.push_back({0, static_cast<int>(n.points.size()), {100, 100}, 0.5, false});
  n.points.push_back(behind);
  const NetworkSummary summary = adjusted(n);
  ASSERT_TRUE(summary.converged) << summary.reason;
  const std::string report = summary.report(n);
  EXPECT_THAT(report, HasSubstr("and \"twin\" first)"));
  EXPECT_THAT(report, HasSubstr("behind the camera  outlier"));
}

TEST(Network, StandardDeviationsFollowResidualsFarAboveTheGivenSigmas) {
  NetworkSite site = arcSite({.controls = 12, .noisePx = 3});
  for (PictureObservation& o : site.network.observations) o.sigmaPx = 0.3;
  NetworkOptions options;
  options.at = {{0, site.points[0]}};
  const NetworkSummary scaled = adjusted(site.network, options);
  ASSERT_TRUE(scaled.converged) << scaled.reason;
  EXPECT_NEAR(scaled.sigma0, 10, 1.5);
  EXPECT_THAT(scaled.report(site.network), HasSubstr("all standard deviations are multiplied by that"));
  for (PictureObservation& o : site.network.observations) o.sigmaPx = 0.3 * scaled.sigma0;
  const NetworkSummary told = adjusted(site.network, options);
  ASSERT_TRUE(told.converged) << told.reason;
  EXPECT_EQ(told.sigmaScale, 1);
  EXPECT_EQ(told.reason, "Converged");
  for (std::size_t f = 0; f < told.poses.size(); ++f) {
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(scaled.poses[f].covariance[i][i] / told.poses[f].covariance[i][i], 1, 0.02);
    EXPECT_NEAR(scaled.poses[f].ellipse.semiMajorM / told.poses[f].ellipse.semiMajorM, 1, 0.01);
  }
  EXPECT_NEAR(scaled.expected[0].millimetres / told.expected[0].millimetres, 1, 0.01);
}

TEST(Network, BadInputIsAnErrorWithItsReason) {
  const NetworkSite good = arcSite();
  const auto expectError = [&](auto change, const std::string& text) {
    Network n = good.network;
    change(n);
    const auto summary = adjustNetwork(n);
    ASSERT_FALSE(summary) << text;
    EXPECT_THAT(summary.error().text(), HasSubstr(text));
  };
  expectError([](Network& n) { n.observations[5].pixel.x = std::nan(""); }, "not finite");
  expectError([](Network& n) { n.observations.push_back(n.observations[5]); }, "duplicate");
  expectError([](Network& n) { n.frames[1].pose = -1; }, "has no pose");
  expectError([](Network& n) { n.frames.pop_back(); std::erase_if(n.observations, [](auto& o) { return o.frame == 5; }); }, "belongs to no frame");
  expectError([](Network& n) { n.frames[1].pictureWidth = 1280, n.frames[1].pictureHeight = 720; }, "1280×720 pixels, its calibration is for 1920×1080");
  expectError([](Network& n) { n.observations[0].sigmaPx = 0; }, "standard deviation");
  expectError([](Network& n) { n.points[0].world.reset(); }, "without coordinates");
  expectError([](Network& n) { n.points[0].world->z = INFINITY; }, "not finite");
  expectError([](Network& n) { n.priors.push_back({0, *n.poses[0].bodyFromWorld, {}}); n.priors[0].covariance[0] = {1, 2, 0, 0, 0, 0}; n.priors[0].covariance[1] = {2, 1, 0, 0, 0, 0}; },
              "not positive definite");
  expectError([](Network& n) { n.poses[2].bodyFromWorld->translation.x = std::nan(""); }, "not finite");
  expectError([](Network& n) { n.depths.push_back({0, 0, -3, 0.1, false}); }, "depth");
}

TEST(Network, RefusesWhatItsObservationsLeaveOpen) {
  const auto expectRefused = [&](const Network& n, const std::string& text) {
    const auto summary = adjustNetwork(n);
    ASSERT_TRUE(summary) << summary.error().text();
    EXPECT_FALSE(summary->converged);
    EXPECT_THAT(summary->reason, HasSubstr(text));
    for (std::size_t i = 0; i < n.poses.size(); ++i)
      EXPECT_LT(glm::length(summary->poses[i].bodyFromWorld.centre() - n.poses[i].bodyFromWorld->centre()), 1e-9);
  };
  expectRefused(arcSite({.controls = 0}).network, "singular");  // no datum at all
  // Mountains all over the picture, a hundred kilometres off: a small part of the distance is a large error all the same.
  NetworkSite far = arcSite({.frames = 1, .ties = 0, .controls = 20, .noisePx = 0});
  const glm::dvec3 eye = far.poses[0].centre();
  for (NetworkPoint& point : far.network.points) *point.world = eye + 3600.0 * (*point.world - eye);
  far.network.poses[0].bodyFromWorld = far.poses[0];
  expectRefused(far.network, "The position of frame \"F1\" is undetermined");
  NetworkSite few = arcSite({.frames = 1, .ties = 0, .controls = 3});
  expectRefused(few.network, "at least 4");
  NetworkSite turned = arcSite();
  turned.network.poses[3].bodyFromWorld = turnedBy(turned.poses[3], {0, 3.14159, 0}, {});
  expectRefused(turned.network, "behind the camera");
  NetworkSite all = arcSite();
  for (NetworkPose& pose : all.network.poses) pose.locked.fill(true);
  expectRefused(all.network, "locked");
}

TEST(Network, AFreeNetworkIsAdjustedWhereItIsAskedFor) {
  NetworkOptions options;
  options.freeNetwork = true;
  const NetworkSite site = arcSite({.ties = 120, .controls = 0});
  const NetworkSummary summary = adjusted(site.network, options);
  ASSERT_TRUE(summary.converged) << summary.reason;
  EXPECT_NEAR(summary.sigma0, 1, 0.15);
  EXPECT_EQ(summary.poses[0].positionStdM.x, 0);
}

}  // namespace
}  // namespace alidade
