// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "align/anchors.h"

namespace alidade {

/// How far off the start may be.
struct SearchRange {
  double rotationRad = 0.0524;  ///< 3°
  double positionM = 0.3;
};

struct PoseCandidate {
  RigidTransform cameraFromWorld;
  double score = 0;  ///< mean over the anchors of what of their correlation lies above chance, 0..1
};

/// The poses within the range at which most anchors find themselves in a small photo: the correlation of every anchor
/// with the photo is tabled over all displacements once, after which a pose costs one look-up an anchor; thousands
/// are drawn (fixed seed), the best climbed from. Best first, `count` at most, none nearer to a better one than
/// `apartPx` at the anchors.
std::vector<PoseCandidate> searchPoses(const std::vector<Anchor>& anchors, const Image<float>& photo, const Camera& camera,
                                       const RigidTransform& start, const SearchRange& range,
                                       int samples, int count, double apartPx);

/// Mean distance in pixels between where two poses put the anchors.
double distancePx(const std::vector<glm::dvec3>& world, const Camera& camera, const RigidTransform& a, const RigidTransform& b);

}  // namespace alidade
