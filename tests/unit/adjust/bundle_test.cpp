// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Bundler's and BAL's problems against Ceres on the same problem from the same start: a camera of its own a picture,
// u = f (1 + k1 r² + k2 r⁴) x / z + cx (Agarwal et al., Bundle adjustment in the large, 2010).

#include <array>
#include <cmath>
#include <filesystem>

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include "adjust/network.h"
#include "bundler/bundler_reader.h"

namespace alidade {
namespace {

struct SnavelyCost {
  glm::dvec2 pixel, centre;
  template <class T>
  bool operator()(const T* pose, const T* lens, const T* world, T* residual) const {
    T p[3];
    ceres::AngleAxisRotatePoint(pose, world, p);
    for (int i = 0; i < 3; ++i) p[i] += pose[3 + i];
    const T x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
    const T scale = lens[0] * (1.0 + lens[1] * r2 + lens[2] * r2 * r2);
    residual[0] = scale * x + (centre.x - pixel.x);
    residual[1] = scale * y + (centre.y - pixel.y);
    return true;
  }
};

double ceresCost(const CameraSet& set, bool freeLens) {
  ceres::Problem problem;
  std::vector<std::array<double, 6>> poses;
  std::vector<std::array<double, 3>> lenses, points;
  poses.reserve(set.pictures.size()), lenses.reserve(set.cameras.size()), points.reserve(set.tiePoints.size());
  for (const Intrinsics& camera : set.cameras) {
    const auto p = camera.parameters();
    lenses.push_back({p[0], p[3], p[4]});
  }
  for (const PosedPicture& picture : set.pictures) {
    const RigidTransform& t = *picture.cameraFromWorld;
    const double q[4] = {t.rotation.w, t.rotation.x, t.rotation.y, t.rotation.z};
    auto& pose = poses.emplace_back();
    ceres::QuaternionToAngleAxis(q, pose.data());
    for (int i = 0; i < 3; ++i) pose[3 + i] = t.translation[i];
  }
  for (const TiePoint& tie : set.tiePoints) {
    auto& point = points.emplace_back(std::array<double, 3>{tie.world.x, tie.world.y, tie.world.z});
    for (const auto& [picture, pixel] : tie.seenIn) {
      const int camera = set.pictures[picture].camera;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<SnavelyCost, 2, 6, 3, 3>(
              new SnavelyCost{pixel, {set.cameras[camera].cx, set.cameras[camera].cy}}),
          nullptr, poses[picture].data(), lenses[camera].data(), point.data());
      if (!freeLens) problem.SetParameterBlockConstant(lenses[camera].data());
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-12, options.gradient_tolerance = 1e-14, options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.final_cost;
}

NetworkSummary adjusted(const CameraSet& set, bool freeLens) {
  Network n;
  for (const Intrinsics& camera : set.cameras) n.cameras.push_back({"camera", camera, freeLens, false, freeLens});
  for (std::size_t i = 0; i < set.pictures.size(); ++i) {
    n.poses.push_back({set.pictures[i].name, set.pictures[i].cameraFromWorld, {}, 0});
    n.frames.push_back({set.pictures[i].name, static_cast<int>(i), set.pictures[i].camera, -1, 0, 0});
  }
  for (const TiePoint& tie : set.tiePoints) {
    const int point = static_cast<int>(n.points.size());
    n.points.push_back({{}, PointKind::Tie, tie.world, {}, {}});
    for (const auto& [picture, pixel] : tie.seenIn) n.observations.push_back({picture, point, pixel, 1.0, false});
  }
  NetworkOptions options;
  options.huberSigmas = 0, options.covariance = false, options.freeNetwork = true, options.maximumIterations = 500;
  const auto summary = adjustNetwork(n, options);
  EXPECT_TRUE(summary) << (summary ? "" : summary.error().text());
  return summary ? *summary : NetworkSummary();
}

std::string shared(const std::string& name) {
  return std::string(ALIDADE_SHARED_DATA_DIR) + "/bundle/examples/Data/" + name;
}

TEST(Bundle, BalbianelloReachesCeresCost) {
  if (!std::filesystem::exists(shared("Balbianello.out"))) GTEST_SKIP() << "no shared data at " << shared("");
  const auto set = BundlerReader().read(shared("Balbianello.out"), {});
  ASSERT_TRUE(set) << set.error().text();
  for (const bool freeLens : {false, true}) {
    const NetworkSummary summary = adjusted(*set, freeLens);
    ASSERT_TRUE(summary.converged) << summary.reason;
    const double peer = ceresCost(*set, freeLens);
    std::printf("Balbianello, lens %s: cost %.6f, Ceres %.6f\n", freeLens ? "free" : "held", summary.finalCost, peer);
    EXPECT_LT(summary.finalCost, peer * 1.001);
    EXPECT_GT(summary.finalCost, peer * 0.999);
  }
}

TEST(Bundle, DubrovnikReachesCeresCost) {
  if (!std::filesystem::exists(shared("dubrovnik-3-7-18-pre.txt"))) GTEST_SKIP() << "no shared data at " << shared("");
  const auto set = BalReader().read(shared("dubrovnik-3-7-18-pre.txt"), {});
  ASSERT_TRUE(set) << set.error().text();
  const NetworkSummary summary = adjusted(*set, false);
  ASSERT_TRUE(summary.converged) << summary.reason;
  const double peer = ceresCost(*set, false);
  std::printf("dubrovnik-3-7-18: cost %.9f, Ceres %.9f\n", summary.finalCost, peer);
  EXPECT_LT(summary.finalCost, peer * 1.001 + 1e-9);
}

}  // namespace
}  // namespace alidade
