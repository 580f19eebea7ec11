// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "camera/camera.h"
#include "geometry/twist.h"

namespace alidade {

/// A camera that reads its rows one after the other, top first, while it moves. A frame's pose is that of the
/// middle row, (height - 1) / 2; row v is read (v - middle) / height × readoutSecs later. Within a frame the camera's
/// velocity is constant.
struct RollingShutter {
  double readoutSecs = 0;  ///< from the start of the first row to the end of the last; < 0: bottom row first
  Twist motion;            ///< pInCamera(t + dt) = exp(motion dt) pInCamera(t), radians and metres a second

  bool isOn() const { return readoutSecs != 0 && (motion.rotation != glm::dvec3(0) || motion.translation != glm::dvec3(0)); }

  /// Seconds from the middle row to row `v` (pixels, need not be whole) of a picture `height` pixels high.
  double secsAtRow(double v, int height) const { return readoutSecs * (v - 0.5 * (height - 1)) / height; }

  /// cameraFromWorld at that row.
  RigidTransform poseAtRow(const RigidTransform& cameraFromWorld, double v, int height) const {
    return exponential(motion * secsAtRow(v, height)) * cameraFromWorld;
  }
};

/// Where a point stands in the axes of the camera at the moment when its own row is read: the row depends on the
/// place and the place on the row, so it is found by iteration from the middle row (a contraction, as long as the
/// picture moves by less than its height during the read-out). The point itself where the shutter is not on, and
/// nothing where the iteration does not settle within 0.01 px or leaves the lens's domain.
std::optional<glm::dvec3> pointAtItsRow(const Camera& camera, const RollingShutter& shutter, const glm::dvec3& pInCamera);

/// Camera::project at the point's own row.
std::optional<glm::dvec2> project(const Camera& camera, const RollingShutter& shutter, const glm::dvec3& pInCamera);

}  // namespace alidade
