// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/start_pose.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

namespace alidade {

namespace {

/// Real roots of a[4] x⁴ + … + a[0], by the companion matrix.
std::vector<double> realRoots(const std::array<double, 5>& a) {
  int degree = 4;
  double largest = 0;
  for (const double c : a) largest = std::max(largest, std::abs(c));
  while (degree > 0 && std::abs(a[degree]) < 1e-14 * largest) --degree;
  if (degree == 0) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  for (int i = 0; i < degree; ++i) companion(i, degree - 1) = -a[i] / a[degree];
  for (int i = 1; i < degree; ++i) companion(i, i - 1) = 1;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(companion, false);
  std::vector<double> roots;
  for (int i = 0; i < degree; ++i) {
    const auto root = solver.eigenvalues()[i];
    // A double root splits into a pair whose imaginary parts are the square root of rounding.
    if (std::abs(root.imag()) < 1e-5 * (1 + std::abs(root.real()))) roots.push_back(root.real());
  }
  return roots;
}

/// Right-handed axes of a triangle; false where it is a line.
bool triad(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, glm::dmat3& axes) {
  const glm::dvec3 u = b - a, n = glm::cross(u, c - a);
  if (!(glm::length(n) > 1e-9 * glm::length(u) * glm::length(c - a))) return false;
  axes[0] = glm::normalize(u), axes[2] = glm::normalize(n), axes[1] = glm::cross(axes[2], axes[0]);
  return true;
}

}  // namespace

std::vector<RigidTransform> posesFromThreePoints(const std::array<glm::dvec3, 3>& rays,
                                                 const std::array<glm::dvec3, 3>& world) {
  const auto squared = [](const glm::dvec3& d) { return glm::dot(d, d); };
  const double a2 = squared(world[1] - world[2]), b2 = squared(world[0] - world[2]), c2 = squared(world[0] - world[1]);
  glm::dmat3 worldAxes;
  if (!(std::min({a2, b2, c2}) > 0) || !triad(world[0], world[1], world[2], worldAxes)) return {};
  const double ca = glm::dot(rays[1], rays[2]), cb = glm::dot(rays[0], rays[2]), cg = glm::dot(rays[0], rays[1]);
  const double minus = (a2 - c2) / b2, plus = (a2 + c2) / b2;
  const std::array<double, 5> quartic{
      (1 + minus) * (1 + minus) - 4 * a2 / b2 * cg * cg,
      4 * (-minus * (1 + minus) * cb + 2 * a2 / b2 * cg * cg * cb - (1 - plus) * ca * cg),
      2 * (minus * minus - 1 + 2 * minus * minus * cb * cb + 2 * (b2 - c2) / b2 * ca * ca - 4 * plus * ca * cb * cg +
           2 * (b2 - a2) / b2 * cg * cg),
      4 * (minus * (1 - minus) * cb - (1 - plus) * ca * cg + 2 * c2 / b2 * ca * ca * cb),
      (minus - 1) * (minus - 1) - 4 * c2 / b2 * ca * ca};
  std::vector<RigidTransform> poses;
  for (const double v : realRoots(quartic)) {
    const double denominator = 2 * (cg - v * ca);
    if (!(v > 0) || std::abs(denominator) < 1e-12) continue;
    const double u = ((minus - 1) * v * v - 2 * minus * cb * v + 1 + minus) / denominator;
    const double s1 = std::sqrt(b2 / (1 + v * v - 2 * v * cb));
    if (!(u > 0) || !std::isfinite(s1)) continue;
    const glm::dvec3 p[3] = {s1 * rays[0], u * s1 * rays[1], v * s1 * rays[2]};
    glm::dmat3 cameraAxes;
    if (!triad(p[0], p[1], p[2], cameraAxes)) continue;
    const glm::dmat3 rotation = cameraAxes * glm::transpose(worldAxes);
    RigidTransform pose;
    pose.rotation = glm::normalize(glm::quat_cast(rotation));
    const glm::dvec3 middle = (world[0] + world[1] + world[2]) / 3.0;
    pose.translation = (p[0] + p[1] + p[2]) / 3.0 - pose.rotation * middle;
    poses.push_back(pose);
  }
  return poses;
}

Result<RigidTransform> findStartPose(const Camera& camera, const std::vector<ResectionObservation>& observations,
                                     const RollingShutter& shutter) {
  std::vector<glm::dvec3> rays, world;
  std::vector<RigidTransform> rowFromMiddle;
  std::vector<int> index;
  glm::dvec3 origin(0);
  for (const auto& o : observations) origin += o.world / static_cast<double>(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (const auto ray = camera.unproject(observations[i].pixel)) {
      rowFromMiddle.push_back(shutter.poseAtRow(RigidTransform::identity(), observations[i].pixel.y, camera.height()));
      // As if the camera had only turned: what it moved by is little beside how far the points are, and the scores know it.
      rays.push_back(glm::conjugate(rowFromMiddle.back().rotation) * glm::normalize(*ray));
      world.push_back(observations[i].world - origin);
      index.push_back(static_cast<int>(i));
    }
  const std::size_t n = rays.size();
  if (n < 4)
    return fail(fmt::format("{} known points are too few to find it from, at least 4 are needed", n), {},
                "Observe more known points, or give an approximate pose");
  // Poses from three points carry their picks' errors magnified: five sigmas and a pixel, truncated (MSAC).
  const auto scoreOf = [&](const RigidTransform& pose, double best) {
    double score = 0;
    for (std::size_t k = 0; k < n && score < best; ++k) {
      const glm::dvec3 p = rowFromMiddle[k] * (pose * world[k]);
      const ResectionObservation& o = observations[index[k]];
      const double limit = 10 * o.sigmaPx + 3;
      double s = 1;
      if (p.z > 0) s = std::min(1.0, glm::length(camera.projectUnchecked(p) - o.pixel) / limit);
      score += std::isfinite(s) ? s * s : 1;
    }
    return score;
  };
  std::mt19937 random(20260611);
  RigidTransform best;
  double lowest = static_cast<double>(n) + 1;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    std::array<std::size_t, 3> chosen;
    chosen[0] = random() % n;
    do chosen[1] = random() % n; while (chosen[1] == chosen[0]);
    do chosen[2] = random() % n; while (chosen[2] == chosen[0] || chosen[2] == chosen[1]);
    for (const RigidTransform& pose : posesFromThreePoints({rays[chosen[0]], rays[chosen[1]], rays[chosen[2]]},
                                                           {world[chosen[0]], world[chosen[1]], world[chosen[2]]})) {
      const double score = scoreOf(pose, lowest);
      if (score < lowest) best = pose, lowest = score;
    }
  }
  if (!(lowest <= static_cast<double>(n)))
    return fail("the known points lie on one line or in one spot", {}, "Observe points beside the line, or give an approximate pose");
  best.translation -= best.rotation * origin;
  ResectionOptions options;
  options.shutter = shutter;
  const auto refined = resect(camera, best, observations, options);
  if (!refined) return fail(refined.error());
  if (!refined->converged) return fail("no pose agrees with the known points (" + refined->reason + ")", {},
                                       "Check the picks and the points' numbers, or give an approximate pose");
  return refined->cameraFromWorld;
}

}  // namespace alidade
