// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "scene/site_view.h"
#include "scene/view_camera.h"

namespace alidade {

/// What one layer has under the cursor: its thing and its depth along the view axis, metres.
struct LayerHit {
  double depth = 0;
  ScenePick pick;
};

/// Distance in pixels from the cursor to a segment between two world points, and the depth there;
/// nothing where the segment is behind the eye.
std::optional<glm::dvec2> distanceToSegmentPx(const ViewCamera& camera, const glm::dvec2& px, const glm::dvec3& a,
                                              const glm::dvec3& b);

}  // namespace alidade
