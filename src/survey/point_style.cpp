// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/point_style.h"

#include <cmath>

namespace alidade {

glm::dvec3 Section::normal() const {
  return {std::sin(azimuthRad) * std::cos(elevationRad), std::cos(azimuthRad) * std::cos(elevationRad),
          std::sin(elevationRad)};
}

std::vector<ClipPlane> PointStyle::clipPlanes() const {
  std::vector<ClipPlane> planes;
  const auto slab = [&](const glm::dvec3& axis, const glm::dvec3& centre, double half) {
    planes.push_back({axis, glm::dot(axis, centre) - half});
    planes.push_back({-axis, -glm::dot(axis, centre) - half});
  };
  if (clipBox.on) {
    const double s = std::sin(clipBox.headingRad), c = std::cos(clipBox.headingRad);
    slab({c, -s, 0}, clipBox.centre, 0.5 * clipBox.size.x);
    slab({s, c, 0}, clipBox.centre, 0.5 * clipBox.size.y);
    slab({0, 0, 1}, clipBox.centre, 0.5 * clipBox.size.z);
  }
  if (section.on && section.thicknessM > 0) slab(section.normal(), section.point, 0.5 * section.thicknessM);
  if (section.on && !(section.thicknessM > 0))
    planes.push_back({-section.normal(), -glm::dot(section.normal(), section.point)});
  return planes;
}

}  // namespace alidade
