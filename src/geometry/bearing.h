// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

namespace alidade {

/// A direction as a compass and a level give it.
struct Bearing {
  double azimuthRad = 0;    ///< clockwise from north
  double elevationRad = 0;  ///< above the horizon
};

/// As a unit vector E, N, up.
glm::dvec3 directionOf(const Bearing& bearing);
/// Azimuth in [0, 2 pi). A zero vector has none and is taken for straight up.
Bearing bearingOf(const glm::dvec3& direction);

}  // namespace alidade
