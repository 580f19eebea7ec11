// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Every analytic derivative against central differences, for every kind of observation and every camera model.

#include <gtest/gtest.h>

#include "adjust/network_checks.h"
#include "network_sites.h"

namespace alidade {
namespace {

Intrinsics modelOf(CameraModel model) {
  std::vector<double> p;
  const double d[] = {-0.08, 0.02, 6e-4, -5e-4, -0.004, 0.01, 0.005, -0.002, 3e-4, -2e-4, 2e-4, 1e-4, 0.01, -0.015};
  switch (model) {
    case CameraModel::SimplePinhole: p = {1150, 965, 532}; break;
    case CameraModel::SimpleRadial: p = {1150, 965, 532, -0.08}; break;
    case CameraModel::Radial: p = {1150, 965, 532, -0.08, 0.02}; break;
    case CameraModel::OpenCvFisheye: p = {1150, 1148, 965, 532, -0.03, 0.01, -0.004, 0.001}; break;
    case CameraModel::BrownHighOrder:
      p = {1150, 1148, 965, 532, -0.08, 0.02, -0.004, 1e-3, -4e-4, 1e-4, 0.01, 0.004, -0.001, 6e-4, -5e-4, 0.1, -0.05, 0.02, 0.01, 1e-3, -8e-4};
      break;
    default:
      p = {1150, 1148, 965, 532};
      p.insert(p.end(), d, d + parameterCount(model) - 4);
  }
  return Intrinsics::fromParameters(model, 1920, 1080, p).value();
}

/// Two cameras on one body, one free mount, all kinds of observations.
Network everything(const Intrinsics& intrinsics) {
  NetworkSiteOptions options;
  options.frames = 4, options.ties = 5, options.controls = 3, options.controlSigmaM = 0.01;
  options.intrinsics = intrinsics;
  Network n = arcSite(options).network;
  n.cameras[0].freeFocal = n.cameras[0].freePrincipalPoint = n.cameras[0].freeDistortion = true;
  n.mounts.push_back({"mount", {glm::normalize(glm::dquat(0.99, 0.02, -0.05, 0.03)), {0.1, -0.2, 0.05}}, {}});
  n.frames[1].mount = n.frames[2].mount = 0;
  n.frames[2].shutter = n.frames[3].shutter = {0.03, {{0.3, -0.5, 0.4}, {1, -2, 0.5}}};
  for (std::size_t i = 0; i < n.points.size(); ++i)
    if (n.points[i].kind == PointKind::Tie) n.points[i].surface = SurfaceHold{{1, 2, 3}, {0.2, -0.3, 0.9}, 0.02};
  for (int f = 0; f < 4; ++f) n.edges.push_back({f, {-3, 0, 1}, {4, 1, 2.5}, {900 + 10.0 * f, 500}, 0.5, false, "edge"});
  n.depths.push_back({0, 4, 25, 0.02, false});
  n.depths.push_back({1, 4, 26, 0.02, false});
  PosePrior prior;
  prior.pose = 2;
  prior.bodyFromWorld = *n.poses[2].bodyFromWorld;
  prior.bodyFromWorld.rotation = glm::normalize(glm::dquat(1, 0.02, -0.04, 0.05) * prior.bodyFromWorld.rotation);
  for (int i = 0; i < 6; ++i) prior.covariance[i][i] = 0.01 * (i + 1);
  prior.covariance[0][4] = prior.covariance[4][0] = 0.005;
  prior.covariance[3][3] = 0;
  n.priors.push_back(prior);
  NetworkTrajectory way;
  for (int f = 0; f < 4; ++f) {
    way.timeSecs.push_back(0.5 * f + 0.1);
    way.bodyFromWorld.push_back(turnedBy(*n.poses[f].bodyFromWorld, {0.02, 0.01, -0.03}, {0.1, 0, 0.2}));
    way.poses.push_back(f);
  }
  way.clockFree = true, way.clockOffsetSecs = 0.03;
  n.trajectories.push_back(way);
  n.smoothness.push_back({{0, 1, 2, 3}, 1, 0.5});
  return n;
}

void expectDerivatives(const Network& network, const std::string& label) {
  ASSERT_TRUE(checkNetwork(network)) << checkNetwork(network).error().text();
  const NetworkLayout layout(network);
  const NetworkTerms terms(network, layout);
  std::vector<std::string> warnings;
  const auto start = startState(network, layout, warnings);
  ASSERT_TRUE(start) << start.error().text();
  const NetworkState& state = *start;
  const auto prepared = terms.prepare(state);
  std::array<int, 10> seen{};
  for (const Term& term : terms.terms()) {
    TermValue value;
    ASSERT_TRUE(terms.evaluate(state, prepared, term, true, value)) << label;
    ++seen[static_cast<int>(term.kind)];
    const auto compare = [&](const std::function<NetworkState(double)>& at, double h, const auto& analytic) {
      TermValue up, down;
      const NetworkState above = at(h), below = at(-h);
      ASSERT_TRUE(terms.evaluate(above, terms.prepare(above), term, false, up));
      ASSERT_TRUE(terms.evaluate(below, terms.prepare(below), term, false, down));
      double length = 0;
      for (int r = 0; r < value.rows; ++r) length += analytic(r) * analytic(r);
      for (int r = 0; r < value.rows; ++r) {
        const double slope = (up.residual[r] - down.residual[r]) / (2 * h);
        EXPECT_NEAR(analytic(r), slope, 2e-6 * (1 + std::sqrt(length)))
            << label << " " << residualKindName(term.kind) << " row " << r;
      }
    };
    std::vector<glm::dvec3> still(layout.slotPoint.size(), glm::dvec3(0));
    for (int b = 0; b < 3; ++b) {
      if (term.blocks[b] < 0) continue;
      const ParameterBlock& block = layout.blocks[term.blocks[b]];
      for (int c = 0; c < block.size; ++c)
        compare(
            [&](double h) {
              std::vector<double> step(layout.unknowns, 0);
              step[block.offset + c] = h;
              return layout.moved(state, step.data(), still);
            },
            1e-6, [&](int r) { return value.byBlock[b][r * block.size + c]; });
    }
    if (term.slot >= 0)
      for (int c = 0; c < 3; ++c)
        compare(
            [&](double h) {
              std::vector<glm::dvec3> step = still;
              step[term.slot][c] = h;
              return layout.moved(state, std::vector<double>(layout.unknowns, 0).data(), step);
            },
            1e-6, [&](int r) { return value.byPoint[3 * r + c]; });
  }
  for (const auto kind : {ResidualKind::Control, ResidualKind::Tie, ResidualKind::Edge, ResidualKind::Depth, ResidualKind::Surface,
                          ResidualKind::Coordinates, ResidualKind::Prior, ResidualKind::Trajectory, ResidualKind::Smoothness})
    EXPECT_GT(seen[static_cast<int>(kind)], 0) << residualKindName(kind);
}

TEST(NetworkDerivatives, EqualDifferencesForEveryKindAndCameraModel) {
  for (const auto model : {CameraModel::SimplePinhole, CameraModel::Pinhole, CameraModel::SimpleRadial, CameraModel::Radial,
                           CameraModel::OpenCv4, CameraModel::OpenCv5, CameraModel::OpenCv8, CameraModel::OpenCv12,
                           CameraModel::OpenCv14, CameraModel::OpenCvFisheye, CameraModel::BrownHighOrder})
    expectDerivatives(everything(modelOf(model)), std::string(cameraModelName(model)));
}

TEST(NetworkDerivatives, TheProjectionIsTheCameras) {
  for (const auto model : {CameraModel::SimpleRadial, CameraModel::OpenCv14, CameraModel::OpenCvFisheye, CameraModel::BrownHighOrder}) {
    const Intrinsics in = modelOf(model);
    const VaryingCamera varying(in);
    const Camera camera(in);
    VaryingCamera::Projection at;
    for (const glm::dvec3 p : {glm::dvec3(0, 0, 5), glm::dvec3(2, -1, 6), glm::dvec3(-0.3, 0.4, 1)}) {
      varying.project(p, true, at);
      const auto expected = camera.project(p);
      ASSERT_TRUE(expected);
      EXPECT_NEAR(glm::length(at.pixel - *expected), 0, 1e-9);
      EXPECT_NEAR(glm::length(varying.project(p) - *expected), 0, 1e-9);
    }
  }
}

}  // namespace
}  // namespace alidade
