// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/workspace.h"
#include "base/progress.h"
#include "camera/rolling_shutter.h"
#include "survey/project.h"

namespace alidade {

// What a pose is refined from: how it is picked, named, and found again in other pictures.

ObservationId nextObservationId(const Project& project);
/// "S1", "S2" …: the first that no observation, control point or stake point bears.
std::string freePointName(const Project& project, const std::string& prefix);

/// Where a pose puts what was observed: a point's own place; of an edge, the place on its line next to the observed one,
/// as the lens draws it. Nothing where the lens does not show it.
std::optional<glm::dvec2> fittedPixel(const Camera& camera, const RollingShutter& shutter, const RigidTransform& cameraFromWorld,
                                      const Observation& seen);

/// Of a depth of a known point: how much farther away than observed its frame's pose has it, metres.
std::optional<double> depthResidualM(const Project& project, const Observation& depth);

/// A corner, or an edge, of the design next to a pixel as the pose shows it.
struct DesignSnap {
  std::string name;  ///< of its element
  glm::dvec3 world{0}, edgeEnd{0};  ///< `edgeEnd` of an edge alone
  double distancePx = 0;
};
/// The nearest end of a visible element's feature edges; the nearer to the camera of those within a pixel of each other.
std::optional<DesignSnap> designCornerAt(const FrameDescription& frame, const glm::dvec2& pixel, double radiusPx);
/// The feature edge whose drawn line passes nearest.
std::optional<DesignSnap> designEdgeAt(const FrameDescription& frame, const glm::dvec2& pixel, double radiusPx);

/// What was found in other frames, and what was not.
struct MatchedObservations {
  std::vector<Observation> observations;  ///< new ones, with free ids and the name of the one they follow
  std::vector<std::string> notes;         ///< a frame each that shows it, but where it could not be matched
};

/// Looks for the mark of an observed point in every other frame that has a pose and should show it, by template from the
/// frame where it was picked (targets/mark_match). Frames where it is already observed are left alone. Error where
/// the observation is of an edge or its own picture cannot be read.
Result<MatchedObservations> matchInOtherFrames(const Project& project, const Observation& seen, PictureCache& pictures,
                                               const Progress& progress);

}  // namespace alidade
