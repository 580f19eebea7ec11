// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "simulate/site_mesh.h"

namespace alidade {

/// Linear RGB albedo of a surface at a place of the site, band-limited to `footprint` metres (what one pixel
/// or one laser spot covers).
glm::vec3 surfaceAlbedo(const SiteObject& object, const glm::dvec3& position, const glm::vec3& normal,
                        float footprint);

/// How much laser light (1550 nm, roughly) a surface sends back at right angles, in [0,1].
float laserReflectance(Material material, const glm::vec3& albedo);

/// Share of mirror-like light and the exponent of its lobe.
glm::vec2 surfaceGloss(Material material);

}  // namespace alidade
