// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "adjust/pose_accuracy.h"

namespace alidade::cli {

// What all answers of `refine` write alike.

inline nlohmann::ordered_json vec(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// NaN and infinity are no JSON numbers.
inline nlohmann::ordered_json finite(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json ellipseOf(const PositionEllipse& ellipse) {
  return {{"semi_major_m", ellipse.semiMajorM}, {"semi_minor_m", ellipse.semiMinorM}, {"azimuth_rad", ellipse.azimuthRad},
          {"height_m", ellipse.heightM}};
}

/// Millimetres: a number for one, a list for several, null for none.
inline nlohmann::ordered_json expectedOf(const std::vector<ExpectedError>& all) {
  if (all.empty()) return nullptr;
  if (all.size() == 1) return finite(all[0].millimetres);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ExpectedError& error : all) list.push_back(finite(error.millimetres));
  return list;
}

}  // namespace alidade::cli
