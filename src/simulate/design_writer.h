// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/error.h"
#include "simulate/site_model.h"

namespace alidade {

/// IFC4 (ISO 16739-1:2018, STEP physical file): project, site, building, storeys; every element an
/// IfcExtrudedAreaSolid in its own placement with openings cut into its profile; property sets and colours.
/// Coordinates are near the site's origin; an IfcMapConversion with rotation leads to the world.
Result<void> writeDesignIfc(const std::string& path, const SiteModel& site);

/// OBJ and MTL of the same: world coordinates with 4 decimals, a group an element, z up.
Result<void> writeDesignObj(const std::string& path, const SiteModel& site);

/// Plain colour of a design element, sRGB in [0,1].
glm::dvec3 designColour(Material material);

}  // namespace alidade
