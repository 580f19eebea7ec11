// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "geometry/rigid_transform.h"

namespace alidade {

/// A rigid motion's velocity, or a motion of unit time: an element of se(3). A point p moves with
/// `rotation × p + translation`, all in the axes of the frame that moves past it.
struct Twist {
  glm::dvec3 rotation{0};     ///< radians, or radians a second
  glm::dvec3 translation{0};  ///< metres, or metres a second; the velocity of the frame's origin

  Twist operator*(double factor) const { return {rotation * factor, translation * factor}; }
  glm::dvec3 velocityOf(const glm::dvec3& p) const { return glm::cross(rotation, p) + translation; }
};

/// The motion after unit time: exp of SE(3), a screw (Murray, Li, Sastry 1994, 2.36).
RigidTransform exponential(const Twist& twist);

/// Its inverse: the shortest screw that leads there, rotation of at most pi.
Twist logarithm(const RigidTransform& motion);

/// The constant screw motion from `a` (t = 0) to `b` (t = 1): exp(t log(b a⁻¹)) a. The same whether both are
/// cameraFromWorld or both worldFromCamera, and whatever the world's origin; t beyond [0, 1] goes on along the screw.
RigidTransform interpolateOnScrew(const RigidTransform& a, const RigidTransform& b, double t);

}  // namespace alidade
