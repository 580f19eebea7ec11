// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>

#include <glm/glm.hpp>

#include "camera/camera.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// Of a pose. Rows and columns: centre E, N, H (metres), then rotation about its own x, y, z (radians). Locked
/// parameters have zero rows. Scaled by the given standard deviations (a priori).
using Covariance6 = std::array<std::array<double, 6>, 6>;

/// Uncertainty of the overlay at an object point, from all that was adjusted.
struct ExpectedError {
  glm::dvec3 world{0};
  double ellipseSemiMajorPx = 0, ellipseSemiMinorPx = 0;  ///< 95 %
  double ellipseAngleRad = 0;                             ///< of the major axis, from +u to +v
  double millimetres = 0;  ///< 95 %: major axis at the point's depth, perpendicular to the ray
};

/// From a pose and its covariance: the pixel's through the full lens, and the point's across the ray. NaN where the camera does
/// not see the point.
ExpectedError expectedError(const Camera& camera, const RigidTransform& cameraFromWorld, const Covariance6& covariance, const glm::dvec3& world);

/// 95 % confidence of a centre: the horizontal ellipse and the height.
struct PositionEllipse {
  double semiMajorM = 0, semiMinorM = 0;
  double azimuthRad = 0;  ///< of the major axis, from north to east
  double heightM = 0;     ///< ± 1.96 standard deviations
};
PositionEllipse positionEllipse(const Covariance6& covariance);

}  // namespace alidade
