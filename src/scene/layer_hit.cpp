// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/layer_hit.h"

#include <algorithm>

namespace alidade {

std::optional<glm::dvec2> distanceToSegmentPx(const ViewCamera& camera, const glm::dvec2& px, const glm::dvec3& a,
                                              const glm::dvec3& b) {
  const auto pa = camera.project(a), pb = camera.project(b);
  if (!pa || !pb) return std::nullopt;
  const glm::dvec2 along = glm::dvec2(*pb) - glm::dvec2(*pa), toCursor = px - glm::dvec2(*pa);
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(glm::dot(toCursor, along) / length2, 0.0, 1.0) : 0.0;
  // Depth is linear in 1/z along a straight line of the picture.
  const double depth = 1.0 / ((1.0 - t) / pa->z + t / pb->z);
  return glm::dvec2(glm::length(toCursor - t * along), depth);
}

}  // namespace alidade
