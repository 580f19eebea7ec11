// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "adjust/pose_accuracy.h"
#include "base/error.h"
#include "camera/camera.h"
#include "camera/rolling_shutter.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// A world point seen at a pixel. Units: metres, pixels in OpenCV's origin.
struct ResectionObservation {
  glm::dvec2 pixel{0};
  glm::dvec3 world{0};
  double sigmaPx = 0.5;
  std::string name;
  double sigmaM = 0;  ///< of the world point on each axis: a point picked in a scan
};

struct ResectionOptions {
  std::array<bool, 3> lockPosition{false, false, false};  ///< E, N, H of the camera's centre
  bool lockAttitude = false;
  double huberSigmas = 2.5;   ///< robust loss: observations beyond this many sigmas lose weight; 0: none
  /// A standardised residual beyond this is an outlier and takes no part, once it is also beyond what
  /// chance gives the worst of so many right picks in one set of a hundred thousand (20 picks: 5.4).
  double outlierSigmas = 3.5;
  int maximumIterations = 100;
  RollingShutter shutter = {};  ///< each point is held to the pose of the row that it was seen in; the pose is the middle row's
  std::vector<glm::dvec3> at; ///< object points where the expected error is wanted, world

  Result<void> validate() const;
};

struct ResectionResidual {
  std::string name;
  glm::dvec2 residualPx{0};  ///< projected - observed
  double sigmas = 0;         ///< |residual| / sigma
  bool outlier = false;      ///< took no part in the adjustment
};

struct ResectionSummary {
  bool converged = false;
  std::string reason;                ///< why it ended, or why it was refused
  RigidTransform cameraFromWorld;    ///< the start where not converged
  int iterations = 0;
  double rmsPx = 0;                  ///< of the inliers
  double sigma0 = 0;                 ///< a posteriori standard deviation of unit weight
  /// All standard deviations, the ellipse and expected errors are multiplied by it: sigma0 where the residuals are far
  /// above the given sigmas, else 1. Never below. As sigma0 is estimated then, 95 % regions are wider still, by Fisher's
  /// distribution instead of the normal one.
  double sigmaScale = 1;
  Covariance6 covariance{};          ///< of the camera's pose
  PositionEllipse ellipse;           ///< 95 % confidence of the camera's centre
  std::vector<std::string> correlations;  ///< pairs of parameters that can hardly be told apart, as sentences
  glm::dvec3 positionStdM{0};
  glm::dvec3 rotationStdRad{0};
  std::vector<ResectionResidual> residuals;
  std::vector<ExpectedError> expected;  ///< one for each of Options::at
  std::vector<std::string> warnings;    ///< one pick under several names

  int outlierCount() const;
  std::string report() const;        ///< a page of text
};

/// Refines one pose from point observations with the camera's full lens (Levenberg-Marquardt, Huber loss).
/// A set that cannot determine the free parameters (too few, collinear, in one spot, behind the
/// camera, non-finite) is refused: converged false, reason says which and what to do.
/// Error only for bad options.
Result<ResectionSummary> resect(const Camera& camera, const RigidTransform& startCameraFromWorld,
                                const std::vector<ResectionObservation>& observations,
                                const ResectionOptions& options = {});

}  // namespace alidade
