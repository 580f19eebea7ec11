// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <random>

#include <fmt/format.h>

#include "adjust/network.h"
#include "sites.h"

namespace alidade {

/// A network with its truth.
struct NetworkSite {
  Network network;
  std::vector<RigidTransform> poses;
  std::vector<glm::dvec3> points;
};

struct NetworkSiteOptions {
  int frames = 6, ties = 60, controls = 6;
  double noisePx = 0.5, controlSigmaM = 0;
  double startShiftM = 0.1, startTurnRad = 0.01;
  glm::dvec3 where{0};
  unsigned seed = 1;
  std::optional<Intrinsics> intrinsics{};
};

/// Cameras on an arc around a site some 20 m across that all of them see.
inline NetworkSite arcSite(const NetworkSiteOptions& o = {}) {
  std::mt19937_64 random(o.seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal;
  const auto three = [&](double size) { return size * glm::dvec3(normal(random), normal(random), normal(random)); };
  NetworkSite site;
  Network& n = site.network;
  n.cameras.push_back({"camera", o.intrinsics.value_or(siteCamera().intrinsics()), false, false, false});
  const Camera camera(n.cameras[0].intrinsics);
  for (int f = 0; f < o.frames; ++f) {
    const double angle = 0.25 * f - 0.6;
    const glm::dvec3 eye = o.where + glm::dvec3(28 * std::sin(angle), -28 * std::cos(angle), 2 + 0.3 * normal(random));
    site.poses.push_back(RigidTransform::cameraLookingAt(eye, o.where + glm::dvec3(0, 0, 1)));
    NetworkPose pose;
    pose.name = fmt::format("F{}", f + 1);
    pose.bodyFromWorld = turnedBy(site.poses.back(), three(o.startTurnRad), three(o.startShiftM));
    pose.timeSecs = 0.5 * f;
    n.poses.push_back(pose);
    n.frames.push_back({pose.name, f, 0, -1, 0, 0});
  }
  for (int p = 0; p < o.ties + o.controls; ++p) {
    const bool control = p < o.controls;
    const glm::dvec3 truth = o.where + glm::dvec3(9 * unit(random), 9 * unit(random), 4 * unit(random) + 2);
    site.points.push_back(truth);
    NetworkPoint point;
    point.name = fmt::format("{}{}", control ? "C" : "T", p + 1);
    point.kind = control ? PointKind::Control : PointKind::Tie;
    if (control) {
      point.world = truth + three(o.controlSigmaM);
      point.sigmaM = glm::dvec3(o.controlSigmaM);
    }
    n.points.push_back(point);
    for (int f = 0; f < o.frames; ++f) {
      const auto pixel = camera.project(site.poses[f] * truth);
      if (!pixel || !camera.inPicture(*pixel)) continue;
      PictureObservation seen;
      seen.frame = f, seen.point = p;
      seen.pixel = *pixel + o.noisePx * glm::dvec2(normal(random), normal(random));
      seen.sigmaPx = o.noisePx > 0 ? o.noisePx : 0.5;
      n.observations.push_back(seen);
    }
  }
  return site;
}

}  // namespace alidade
