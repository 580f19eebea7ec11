// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <vector>

#include "adjust/resection.h"

namespace alidade {

/// The poses, four at most, from which three points are seen along three unit rays (camera axes): Grunert's (1841)
/// distances by the quartic of Haralick et al. (1994), then the rotation between the two triangles. Empty for
/// points on one line.
std::vector<RigidTransform> posesFromThreePoints(const std::array<glm::dvec3, 3>& rays, const std::array<glm::dvec3, 3>& world);

/// An approximate pose from nothing but observations, however many of them are wrong as long as half are right:
/// three at a time (fixed seed) give poses, the one that most others agree with is refined on them. Error, with the
/// reason, where fewer than four observations, or fewer than two fifths of them, agree with any pose.
Result<RigidTransform> findStartPose(const Camera& camera, const std::vector<ResectionObservation>& observations,
                                     const RollingShutter& shutter = {});

}  // namespace alidade
