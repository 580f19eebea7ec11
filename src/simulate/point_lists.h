// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "camera/camera.h"
#include "simulate/ray_scene.h"
#include "simulate/site_model.h"

namespace alidade {

/// `name,E,N,H,code,tolerance`, metres.
Result<void> writeStakePoints(const std::string& path, const SiteModel& site);

/// `name,E,N,H,sigma`, metres.
Result<void> writeControlPoints(const std::string& path, const SiteModel& site);

/// A control point where a frame truly sees it.
struct SeenControlPoint {
  int point = 0;          ///< index into SiteModel::controlPoints
  glm::dvec2 pixel{0.0};  ///< exact
};

/// The control points that a frame sees: in the picture, from the front, with nothing before them.
std::vector<SeenControlPoint> seenControlPoints(const SiteModel& site, const RayScene& scene,
                                                const Camera& camera, const RigidTransform& cameraFromSite);

/// `u,v,e,n,h,sigma_px,name` with this much noise on the pixels.
Result<void> writeObservations(const std::string& path, const SiteModel& site,
                               const std::vector<SeenControlPoint>& seen, double sigmaPx, std::uint32_t seed);

}  // namespace alidade
