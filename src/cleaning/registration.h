// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/progress.h"
#include "geometry/rigid_transform.h"

namespace alidade {

struct RegistrationOptions {
  double reachMeters = 0.5;      ///< how far apart the scans may be where they overlap
  double leastShare = 0.3;       ///< of the moving points that must find a partner
  int iterations = 100;
  std::size_t mostPoints = 200000;  ///< of each scan, thinned evenly
};

/// How a moving scan fits a fixed one. Residuals are those of the pairs used, after the fit.
struct Registration {
  RigidTransform fixedFromMoving;   ///< world to world: p' = fixedFromMoving * p
  glm::dvec3 shiftMeters{0};        ///< how far the moving scan's middle moves
  double rmsPlaneMeters = 0;        ///< along the fixed scan's normals: what the fit made small
  double rmsPointMeters = 0;        ///< between the points themselves; holds their spacing, too
  double share = 0;                 ///< of the moving points with a partner
  std::size_t pairs = 0;
  int iterations = 0;

  std::string report() const;
};

/// Iterative closest point of scan to scan, point to plane (Chen and Medioni 1992): pairs within a reach that
/// shrinks with the residuals, normals of the fixed scan, Gauss-Newton steps of six parameters about the moving scan's middle.
///
/// Refused, with its reason: fewer than 100 points, no convergence, too small an overlap, and surfaces that leave a
/// direction open (a single plane slides on itself).
Result<Registration> registerScan(std::span<const glm::dvec3> moving, std::span<const glm::dvec3> fixed, const RegistrationOptions& options,
                                  const Progress& progress);

}  // namespace alidade
