// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

#include "survey/point_style.h"

namespace alidade {

/// The colour at `share` (0 low, 1 high; beyond: the end's). Viridis is matplotlib's (Smith and van der
/// Walt 2015), Cividis that of Nuñez, Anderton and Renslow (2018), both interpolated between nine of their colours.
glm::u8vec3 rampColour(ColourRamp ramp, double share);

/// 256 steps of the ramp as RGB565, for painting many points.
std::array<std::uint16_t, 256> rampTable(ColourRamp ramp);

inline std::uint16_t rgb565(const glm::u8vec3& c) {
  return static_cast<std::uint16_t>(((c.r >> 3) << 11) | ((c.g >> 2) << 5) | (c.b >> 3));
}

}  // namespace alidade
