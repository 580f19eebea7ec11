// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// A world point seen at a pixel. Units: metres, pixels in OpenCV's origin.
struct ResectionObservation {
  glm::dvec2 pixel{0};
  glm::dvec3 world{0};
  double sigmaPx = 0.5;
  std::string name;
};

struct ResectionOptions {
  std::array<bool, 3> lockPosition{false, false, false};  ///< E, N, H of the camera's centre
  bool lockAttitude = false;
  double huberSigmas = 2.5;   ///< robust loss: observations beyond this many sigmas lose weight; 0: none
  /// A standardised residual beyond this is an outlier and takes no part, once it is also beyond what
  /// chance gives the worst of so many right picks in one set of a thousand (20 picks: 4.5).
  double outlierSigmas = 3.5;
  int maximumIterations = 100;
  std::vector<glm::dvec3> at; ///< object points where the expected error is wanted, world

  Result<void> validate() const;
};

struct ResectionResidual {
  std::string name;
  glm::dvec2 residualPx{0};  ///< projected - observed
  double sigmas = 0;         ///< |residual| / sigma
  bool outlier = false;      ///< took no part in the adjustment
};

/// Uncertainty of the overlay at an object point, from the pose's covariance.
struct ExpectedError {
  glm::dvec3 world{0};
  double ellipseSemiMajorPx = 0, ellipseSemiMinorPx = 0;  ///< 95 %
  double ellipseAngleRad = 0;                             ///< of the major axis, from +u to +v
  double millimetres = 0;  ///< 95 %: major axis at the point's depth, perpendicular to the ray
};

struct ResectionSummary {
  bool converged = false;
  std::string reason;                ///< why it ended, or why it was refused
  RigidTransform cameraFromWorld;    ///< the start where not converged
  int iterations = 0;
  double rmsPx = 0;                  ///< of the inliers
  double sigma0 = 0;                 ///< a posteriori standard deviation of unit weight
  /// Rows and columns: centre E, N, H (metres), then rotation about the camera's x, y, z (radians).
  /// Locked parameters have zero rows. Scaled by the given sigmas (a priori).
  std::array<std::array<double, 6>, 6> covariance{};
  glm::dvec3 positionStdM{0};
  glm::dvec3 rotationStdRad{0};
  std::vector<ResectionResidual> residuals;
  std::vector<ExpectedError> expected;  ///< one for each of Options::at

  int outlierCount() const;
  std::string report() const;        ///< a page of text
};

/// Refines one pose from point observations with the camera's full lens (Ceres, Huber loss).
/// A set that cannot determine the free parameters (too few, collinear, in one spot, behind the
/// camera, non-finite) is refused: converged false, reason says which and what to do.
/// Error only for bad options.
Result<ResectionSummary> resect(const Camera& camera, const RigidTransform& startCameraFromWorld,
                                const std::vector<ResectionObservation>& observations,
                                const ResectionOptions& options = {});

}  // namespace alidade
