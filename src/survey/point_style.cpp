// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/point_style.h"

#include <algorithm>
#include <cmath>

#include "geometry/bearing.h"

namespace alidade {

glm::dvec3 Section::normal() const {
  return directionOf({azimuthRad, elevationRad});
}

glm::dvec3 CutPlane::normal() const {
  return directionOf({azimuthRad, elevationRad});
}

bool PointStyle::filters() const {
  return hiddenClasses.any() || clipBox.on || section.on || std::ranges::any_of(cuts, &CutPlane::on);
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
  const auto behind = [&](const glm::dvec3& normal, const glm::dvec3& point) { planes.push_back({-normal, -glm::dot(normal, point)}); };
  if (section.on && !(section.thicknessM > 0)) behind(section.normal(), section.point);
  for (const CutPlane& cut : cuts)
    if (cut.on) behind(cut.normal(), cut.point);
  return planes;
}

}  // namespace alidade
