// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>

#include <Eigen/Core>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace alidade {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A pose as a solver holds it: the centre relative to the problem's origin, so that survey coordinates
/// of 10⁷ m cost no digits, and the attitude.
struct PoseState {
  glm::dvec3 centre{0};                     ///< metres from the problem's origin
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< camera (or body) axes from world axes, unit
};

/// The rotation exp([w]×).
inline glm::dquat quaternionOf(const glm::dvec3& rotationVector) {
  const double angle = glm::length(rotationVector);
  // sin(angle/2)/angle, by its series near zero.
  const double share = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), share * rotationVector.x, share * rotationVector.y, share * rotationVector.z};
}

/// Its inverse: the shortest rotation vector of a unit quaternion.
inline glm::dvec3 rotationVectorOf(glm::dquat q) {
  if (q.w < 0) q = -q;
  const glm::dvec3 v(q.x, q.y, q.z);
  const double sine = glm::length(v);
  return sine < 1e-8 ? 2.0 * v : 2 * std::atan2(sine, q.w) / sine * v;
}

/// `step`: centre E N H, then rotation about the pose's own x y z: R' = exp([w]×) R.
inline PoseState moved(const PoseState& state, const double* step) {
  PoseState to;
  to.centre = state.centre + glm::dvec3(step[0], step[1], step[2]);
  to.rotation = glm::normalize(quaternionOf({step[3], step[4], step[5]}) * state.rotation);
  return to;
}

}  // namespace alidade
