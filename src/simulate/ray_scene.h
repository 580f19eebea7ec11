// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include <glm/glm.hpp>

#include "base/error.h"
#include "simulate/site_mesh.h"

namespace alidade {

/// Where a ray first meets a mesh.
struct RayHit {
  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  std::uint32_t triangle = none;
  double distance = std::numeric_limits<double>::infinity();  ///< along the direction's own length
  glm::vec3 faceNormal{0.0f};                                 ///< unit, towards the ray's origin
  glm::vec3 normal{0.0f};                                     ///< smoothed, towards the ray's origin
  explicit operator bool() const { return triangle != none; }
};

/// Ray queries against a mesh, by Embree; the distance is refined in double on the triangle that was hit.
/// Thread-safe once made. The mesh must outlive it.
class RayScene {
 public:
  static Result<RayScene> make(const SiteMesh& mesh);
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;
  ~RayScene();

  /// Directions need not be unit.
  RayHit intersect(const glm::dvec3& origin, const glm::dvec3& direction, double farthest = 1e4) const;
  /// True where something stands between origin and origin + farthest * direction.
  bool occluded(const glm::dvec3& origin, const glm::dvec3& direction, double farthest = 1e4) const;

  const SiteMesh& mesh() const { return *m_mesh; }
  const SiteObject& objectOf(std::uint32_t triangle) const {
    return m_mesh->objects[m_mesh->triangleObject[triangle]];
  }

 private:
  struct Handles;
  RayScene();
  std::unique_ptr<Handles> m_handles;
  const SiteMesh* m_mesh = nullptr;
};

}  // namespace alidade
