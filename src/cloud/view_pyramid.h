// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>

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
  /// False only where no point of the box can fall into the picture.
  bool maySee(const Bounds& bounds) const;
  /// From the eye to the nearest point of the box, metres; 0 inside it.
  double distanceTo(const Bounds& bounds) const;

 private:
  glm::dvec3 m_eye{0};
  std::array<glm::dvec3, 5> m_planes;  ///< inward normals in the world, all through the eye
  std::size_t m_planeCount = 5;        ///< 1 where the lens has no bound to the sides
};

}  // namespace alidade
