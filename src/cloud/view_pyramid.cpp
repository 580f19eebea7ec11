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

unsigned ViewPyramid::cutBy(const Bounds& bounds, unsigned planes) const {
  const glm::dvec3 middle = 0.5 * (bounds.min + bounds.max) - m_eye, half = 0.5 * (bounds.max - bounds.min);
  unsigned cutting = 0;
  for (unsigned i = 0; i < m_planeCount; ++i) {
    if ((planes >> i & 1) == 0) continue;
    const double at = glm::dot(m_planes[i], middle), reach = glm::dot(glm::abs(m_planes[i]), half);
    // The products round: what touches a plane counts as cut.
    const double slack = 1e-12 * (glm::abs(m_planes[i].x * middle.x) + glm::abs(m_planes[i].y * middle.y) + glm::abs(m_planes[i].z * middle.z) + reach);
    if (at + reach < -slack) return kOutside;
    if (at - reach <= slack) cutting |= 1u << i;
  }
  return cutting;
}

}  // namespace alidade
