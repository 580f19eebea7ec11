// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/point_lists.h"

#include <fmt/format.h>

#include "simulate/output_file.h"
#include "simulate/random.h"

namespace alidade {

Result<void> writeStakePoints(const std::string& path, const SiteModel& site) {
  std::string text = "name,E,N,H,code,tolerance\n";
  for (const NamedPoint& point : site.stakePoints) {
    const glm::dvec3 p = site.worldFromSite * point.position;
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{},{}\n", point.name, p.x, p.y, p.z, point.code,
                        point.tolerance);
  }
  return writeWholeFile(path, text);
}

Result<void> writeControlPoints(const std::string& path, const SiteModel& site) {
  std::string text = "name,E,N,H,sigma\n";
  for (const NamedPoint& point : site.controlPoints) {
    const glm::dvec3 p = site.worldFromSite * point.position;
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{}\n", point.name, p.x, p.y, p.z, point.tolerance);
  }
  return writeWholeFile(path, text);
}

std::vector<SeenControlPoint> seenControlPoints(const SiteModel& site, const RayScene& scene,
                                                const Camera& camera, const RigidTransform& cameraFromSite) {
  std::vector<SeenControlPoint> seen;
  const glm::dvec3 eye = cameraFromSite.centre();
  for (std::size_t i = 0; i < site.controlPoints.size(); ++i) {
    const NamedPoint& point = site.controlPoints[i];
    const glm::dvec3 sight = point.position - eye;
    if (glm::dot(sight, point.normal) > -0.2 * glm::length(sight)) continue;
    const auto pixel = camera.project(cameraFromSite * point.position);
    if (!pixel || !camera.inPicture(*pixel)) continue;
    if (scene.occluded(eye, sight, 1.0 - 0.01 / glm::length(sight))) continue;
    seen.push_back({static_cast<int>(i), *pixel});
  }
  return seen;
}

Result<void> writeObservations(const std::string& path, const SiteModel& site,
                               const std::vector<SeenControlPoint>& seen, double sigmaPx,
                               std::uint32_t seed) {
  std::string text = "u,v,e,n,h,sigma_px,name\n";
  for (const SeenControlPoint& one : seen) {
    const NamedPoint& point = site.controlPoints[one.point];
    const glm::dvec3 p = site.worldFromSite * point.position;
    Random random(seed, 601, static_cast<std::uint64_t>(one.point));
    const double u = one.pixel.x + sigmaPx * random.normal(), v = one.pixel.y + sigmaPx * random.normal();
    text +=
        fmt::format("{:.3f},{:.3f},{:.4f},{:.4f},{:.4f},{},{}\n", u, v, p.x, p.y, p.z, sigmaPx, point.name);
  }
  return writeWholeFile(path, text);
}

}  // namespace alidade
