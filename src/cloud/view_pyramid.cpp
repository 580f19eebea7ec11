// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/view_pyramid.h"

#include <cmath>

namespace alidade {

ViewPyramid::ViewPyramid(const Camera& camera, const RigidTransform& cameraFromWorld) : m_eye(cameraFromWorld.centre()) {
  glm::dvec2 low(0.0), high(0.0);
  bool whole = true;
  const auto look = [&](double u, double v) {
    const auto direction = camera.unproject({u, v});
    whole = whole && direction.has_value();
    if (!direction) return;
    low = glm::min(low, glm::dvec2(*direction));
    high = glm::max(high, glm::dvec2(*direction));
  };
  // The lens maps the picture's border onto the border of what it sees, so the border is enough.
  constexpr int kSteps = 64;
  for (int i = 0; i <= kSteps; ++i) {
    const double u = -0.5 + camera.width() * (i / static_cast<double>(kSteps));
    const double v = -0.5 + camera.height() * (i / static_cast<double>(kSteps));
    for (const double edge : {-0.5, camera.height() - 0.5}) look(u, edge);
    for (const double edge : {-0.5, camera.width() - 0.5}) look(edge, v);
  }
  const double reach = camera.imageRadius();
  if (!whole) low = glm::dvec2(-reach), high = glm::dvec2(reach);
  // Between two samples the border may bulge by a little.
  const glm::dvec2 margin = 0.01 * (high - low) + 1e-3;
  low = glm::max(low - margin, glm::dvec2(-reach));
  high = glm::min(high + margin, glm::dvec2(reach));
  m_planes = {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, -low.x), glm::dvec3(-1, 0, high.x), glm::dvec3(0, 1, -low.y),
              glm::dvec3(0, -1, high.y)};
  const glm::dmat3 worldFromCamera = glm::transpose(cameraFromWorld.rotationMatrix());
  for (glm::dvec3& plane : m_planes) plane = worldFromCamera * plane;
  if (!std::isfinite(reach) && !whole) m_planeCount = 1;
}

bool ViewPyramid::maySee(const Bounds& bounds) const {
  const glm::dvec3 low = bounds.min - m_eye, high = bounds.max - m_eye;
  for (std::size_t i = 0; i < m_planeCount; ++i) {
    // The corner that lies farthest along the normal.
    const glm::dvec3& n = m_planes[i];
    const double most = n.x * (n.x > 0 ? high.x : low.x) + n.y * (n.y > 0 ? high.y : low.y) + n.z * (n.z > 0 ? high.z : low.z);
    if (most < 0.0) return false;
  }
  return true;
}

double ViewPyramid::distanceTo(const Bounds& bounds) const {
  return glm::length(glm::clamp(m_eye, bounds.min, bounds.max) - m_eye);
}

}  // namespace alidade
