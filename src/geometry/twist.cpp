// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/twist.h"

#include <cmath>

namespace alidade {

namespace {

// Below this angle the series are exact in double and the closed forms lose digits.
constexpr double kSmallAngle = 1e-4;

}  // namespace

RigidTransform exponential(const Twist& twist) {
  const glm::dvec3 w = twist.rotation, v = twist.translation;
  const double angle2 = glm::dot(w, w), angle = std::sqrt(angle2);
  // sin(a/2)/a for the quaternion; (1-cos a)/a² and (a-sin a)/a³ for the left Jacobian.
  double half = 0.5 - angle2 / 48, b = 0.5 - angle2 / 24, c = 1.0 / 6 - angle2 / 120;
  if (angle > kSmallAngle) {
    half = std::sin(0.5 * angle) / angle;
    b = 2 * half * half;
    c = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const glm::dvec3 axis = half * w;
  RigidTransform motion;
  motion.rotation = glm::normalize(glm::dquat(std::cos(0.5 * angle), axis.x, axis.y, axis.z));
  const glm::dvec3 wv = glm::cross(w, v);
  motion.translation = v + b * wv + c * glm::cross(w, wv);
  return motion;
}

Twist logarithm(const RigidTransform& motion) {
  glm::dquat q = motion.rotation;
  if (q.w < 0) q = -q;
  const glm::dvec3 axis(q.x, q.y, q.z);
  const double sine = glm::length(axis);
  const double angle = 2 * std::atan2(sine, q.w), angle2 = angle * angle;
  const double perSine = sine > 0.5 * kSmallAngle ? angle / sine : 2 + angle2 / 12;
  Twist twist;
  twist.rotation = perSine * axis;
  // V⁻¹ = 1 - w×/2 + d w×w×, d = (1 - (a/2) cot(a/2)) / a².
  double d = 1.0 / 12 + angle2 / 720;
  if (angle > kSmallAngle) d = (1 - 0.5 * angle * q.w / sine) / angle2;
  const glm::dvec3 wt = glm::cross(twist.rotation, motion.translation);
  twist.translation = motion.translation - 0.5 * wt + d * glm::cross(twist.rotation, wt);
  return twist;
}

RigidTransform interpolateOnScrew(const RigidTransform& a, const RigidTransform& b, double t) {
  // About a's origin in the world: at 10⁷ m the two translations would cancel digits away. Both are moved by
  // the same, which the screw does not feel.
  const glm::dvec3 origin = a.centre();
  const RigidTransform nearA{a.rotation, glm::dvec3(0)}, nearB{b.rotation, b * origin};
  RigidTransform pose = exponential(logarithm(nearB * nearA.inverse()) * t) * nearA;
  pose.translation -= pose.rotation * origin;
  return pose;
}

}  // namespace alidade
