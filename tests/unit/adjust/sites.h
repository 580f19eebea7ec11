// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <random>
#include <vector>

#include <fmt/format.h>

#include "adjust/resection.h"

namespace alidade {

/// A camera with strong barrel distortion in front of a scattered site, and picks with known noise.
struct Site {
  Camera camera;
  RigidTransform truth;  ///< cameraFromWorld
  RigidTransform start;  ///< off by half a metre and two degrees
  std::vector<ResectionObservation> picks;
};

inline Camera siteCamera() {
  return Camera(Intrinsics::fromParameters(CameraModel::OpenCv5, 1920, 1080,
                                           {1150, 1148, 965, 532, -0.26, 0.09, 8e-4, -6e-4, -0.012})
                    .value());
}

inline RigidTransform turnedBy(const RigidTransform& cameraFromWorld, const glm::dvec3& rotationVector,
                               const glm::dvec3& shift) {
  const double angle = glm::length(rotationVector);
  const glm::dquat turn = angle > 0 ? glm::angleAxis(angle, rotationVector / angle) : glm::dquat(1, 0, 0, 0);
  RigidTransform moved;
  moved.rotation = glm::normalize(turn * cameraFromWorld.rotation);
  moved.translation = -(moved.rotation * (cameraFromWorld.centre() + shift));
  return moved;
}

/// `count` points all over the picture, 8 to 40 m away, seen with `noisePx`.
inline Site randomSite(unsigned seed, int count, double noisePx, const glm::dvec3& where = {0, 0, 0}) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  Site site;
  site.camera = siteCamera();
  const glm::dvec3 eye = where + glm::dvec3(3 * normal(random), 3 * normal(random), 1.7);
  const glm::dvec3 target = eye + glm::dvec3(20 * std::cos(seed), 20 * std::sin(seed), 2 * normal(random));
  site.truth = RigidTransform::cameraLookingAt(eye, target);
  const RigidTransform worldFromCamera = site.truth.inverse();
  while (static_cast<int>(site.picks.size()) < count) {
    const glm::dvec2 pixel(40 + 1840 * unit(random), 40 + 1000 * unit(random));
    const double depth = 8 + 32 * unit(random);
    ResectionObservation pick;
    pick.world = worldFromCamera * (depth * *site.camera.unproject(pixel));
    // Seen where the rounded world point really projects.
    pick.pixel = *site.camera.project(site.truth * pick.world);
    pick.pixel += noisePx * glm::dvec2(normal(random), normal(random));
    pick.sigmaPx = noisePx > 0 ? noisePx : 0.5;
    pick.name = fmt::format("P{}", site.picks.size() + 1);
    site.picks.push_back(pick);
  }
  const auto three = [&](double size) { return size * glm::dvec3(normal(random), normal(random), normal(random)); };
  site.start = turnedBy(site.truth, three(0.035 / 1.7), three(0.5 / 1.7));
  return site;
}

/// Error of a pose in the summary's order: centre E N H, then rotation about the camera's x y z.
inline std::array<double, 6> poseError(const RigidTransform& estimate, const RigidTransform& truth) {
  const glm::dvec3 shift = truth.centre() - estimate.centre();
  glm::dquat between = truth.rotation * glm::conjugate(estimate.rotation);
  if (between.w < 0) between = -between;
  return {shift.x, shift.y, shift.z, 2 * between.x, 2 * between.y, 2 * between.z};
}

}  // namespace alidade
