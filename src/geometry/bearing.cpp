// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/bearing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

glm::dvec3 directionOf(const Bearing& bearing) {
  const double level = std::cos(bearing.elevationRad);
  return {std::sin(bearing.azimuthRad) * level, std::cos(bearing.azimuthRad) * level, std::sin(bearing.elevationRad)};
}

Bearing bearingOf(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!(length > 0)) return {0, 0.5 * std::numbers::pi};
  double azimuth = std::atan2(direction.x, direction.y);
  if (azimuth < 0) azimuth += 2 * std::numbers::pi;
  if (azimuth >= 2 * std::numbers::pi) azimuth = 0;  // what rounding made of the least below north
  return {azimuth, std::asin(std::clamp(direction.z / length, -1.0, 1.0))};
}

}  // namespace alidade
