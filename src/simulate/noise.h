// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

namespace alidade {

/// Value noise in [0,1] with unit lattice, smooth; deterministic.
float valueNoise(const glm::vec3& p);
float valueNoise(const glm::vec2& p);

/// Sum of `octaves` of value noise, the first with unit wavelength, in [0,1], mean 0.5. Octaves whose
/// wavelength is below twice `footprint` (same unit as p) fade out, so that a far surface does not alias.
float fractalNoise(const glm::vec3& p, int octaves, float footprint);
float fractalNoise(const glm::vec2& p, int octaves, float footprint);

/// A random number in [0,1) for a lattice cell.
float cellNoise(int x, int y, int z);

}  // namespace alidade
