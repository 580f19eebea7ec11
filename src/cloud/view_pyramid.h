// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cmath>

#include <glm/glm.hpp>

#include "camera/camera.h"
#include "geometry/bounds.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// The lens's field of view as a pyramid on the undistorted image plane: wide enough for every
/// pixel of the distorted picture.
class ViewPyramid {
 public:
  ViewPyramid(const Camera& camera, const RigidTransform& cameraFromWorld);

  const glm::dvec3& eye() const { return m_eye; }
  /// All planes, for cutBy.
  static constexpr unsigned kAllPlanes = 31;
  /// Lies outside what the lens sees.
  static constexpr unsigned kOutside = 32;
  /// Which of `planes` cut the box, as bits; kOutside only where no point of it can fall into the picture. What
  /// does not cut a box cuts none inside it.
  unsigned cutBy(const Bounds& bounds, unsigned planes) const;
  /// From the eye to the nearest point of the box, metres; 0 inside it.
  double distanceTo(const Bounds& bounds) const { return std::sqrt(squaredDistanceTo(bounds)); }
  double squaredDistanceTo(const Bounds& bounds) const {
    const glm::dvec3 apart = glm::max(glm::max(bounds.min - m_eye, m_eye - bounds.max), glm::dvec3(0.0));
    return glm::dot(apart, apart);
  }

 private:
  glm::dvec3 m_eye{0};
  std::array<glm::dvec3, 5> m_planes;  ///< inward normals in the world, all through the eye
  std::size_t m_planeCount = 5;        ///< 1 where the lens has no bound to the sides
};

}  // namespace alidade
