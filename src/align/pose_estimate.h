// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "adjust/pose_accuracy.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// Where a place of the world was seen, as surely as `information` says. Places of one block share what is wrong with
/// them: a part of the scan that lies a little off, a shadow.
struct SeenPlace {
  glm::dvec3 world{0};
  glm::dvec2 pixel{0};
  glm::dmat2 information{0};  ///< inverse covariance, 1/px²; may be singular
  int block = 0;
};

struct PoseEstimate {
  RigidTransform cameraFromWorld;
  std::vector<double> weights;   ///< of each place, 0..1
  double sigma0 = 1;             ///< robust standard deviation of unit weight
  /// Centre E N H, rotation about the camera's x y z: from how much the pose moves when a block is left out (jackknife,
  /// Quenouille 1949, Tukey 1958), at least what the places' own information gives.
  Covariance6 covariance{};
  glm::dvec3 positionStdM{0}, rotationStdRad{0};
  double rmsPx = 0;              ///< of the places that count for half or more, along what they know
  double changePx = 0;           ///< root mean square over the places of what the covariance does to a pixel

  int counting() const;          ///< places with half their weight or more
};

/// What is known of the pose beforehand: standard deviations of each axis of centre and attitude, and what is locked.
struct PoseKnowledge {
  RigidTransform cameraFromWorld;
  double positionSigmaM = 0, rotationSigmaRad = 0;  ///< 0: nothing known
  std::array<bool, 6> locked{};                     ///< centre E N H, rotation about the camera's x y z
};

/// The pose with what is locked as it is known. The attitude counts as locked about all three axes or about none.
RigidTransform withLocked(const RigidTransform& cameraFromWorld, const PoseKnowledge& known);

/// The pose that most of the places agree with, by reweighted least squares with Cauchy's weights from a pose nearby.
/// Nothing where fewer than three blocks remain or the places leave something open.
std::optional<PoseEstimate> estimatePose(const Camera& camera, const RigidTransform& start, const std::vector<SeenPlace>& places,
                                         const PoseKnowledge& known = {});

}  // namespace alidade
