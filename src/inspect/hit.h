// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "base/image.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "survey/project.h"

namespace alidade {

/// The scanned surface behind a pixel.
struct Hit {
  glm::dvec3 world{0};           ///< metres
  double depthM = 0;             ///< along the optical axis
  double distanceM = 0;          ///< from the camera's centre
  std::optional<double> sigmaM;  ///< one standard deviation; empty where the pose's quality is unknown
};

/// What the hit's uncertainty is made of.
struct HitUncertainty {
  std::optional<PoseQuality> pose;
  double scanSpacingM = 0;  ///< median distance between the scan's points
};

/// World point that a pixel sees: the ray through the full lens, cut at the scan's depth. Nothing where
/// the depth is unknown or the pixel lies outside. `camera` has the depth picture's size.
/// sigma² = |position std|² + (|rotation std| distance)² + spacing² / 12.
std::optional<Hit> hitAt(const DepthImage& scanDepth, const Camera& camera, const RigidTransform& cameraFromWorld,
                         const glm::dvec2& pixel, const HitUncertainty& uncertainty = {});

/// From one point to another, in the surveyor's terms.
struct Measurement {
  double slopeM = 0;       ///< straight distance
  double horizontalM = 0;
  double heightM = 0;      ///< to - from
  double azimuthRad = 0;   ///< from grid north, clockwise, [0, 2 pi)
  std::optional<double> sigmaM;  ///< of the slope distance
};
Measurement measure(const Hit& from, const Hit& to);

/// What is there against what should be: as-built minus design.
struct StakeOutDelta {
  glm::dvec3 deltaM{0};    ///< E, N, H
  double horizontalM = 0;
  double cutM = 0;         ///< above 0: dig away; below 0: fill up
  bool within = false;     ///< horizontal deviation at most the point's tolerance
};
StakeOutDelta stakeOutDelta(const StakePoint& design, const glm::dvec3& asBuilt);

}  // namespace alidade
