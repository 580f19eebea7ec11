// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "camera/camera.h"

namespace alidade {

/// Weighted reprojection residual of one observation for Ceres' automatic differentiation, the tests' oracle:
/// (projected - observed) / sigma, through the lens of lens_kernel.h.
///
/// Unknowns: the camera centre relative to `origin` (3, metres), so that survey coordinates of 10⁷ m
/// cost no digits, and the unit quaternion w x y z that turns world into camera axes.
struct ReprojectionCost {
  const Camera* camera = nullptr;
  glm::dvec2 pixel{0};
  glm::dvec3 worldFromOrigin{0};  ///< world point minus origin
  double sigmaPx = 1;

  template <class T>
  bool operator()(const T* centre, const T* q, T* residual) const {
    const T world[3] = {T(worldFromOrigin.x), T(worldFromOrigin.y), T(worldFromOrigin.z)};
    return (*this)(centre, q, world, residual);
  }

  /// The same with the point unknown as well.
  template <class T>
  bool operator()(const T* centre, const T* q, const T* world, T* residual) const {
    const T d[3] = {world[0] - centre[0], world[1] - centre[1], world[2] - centre[2]};
    // p = d + 2 w (v × d) + 2 v × (v × d), v the quaternion's vector part.
    const T c[3] = {q[2] * d[2] - q[3] * d[1], q[3] * d[0] - q[1] * d[2], q[1] * d[1] - q[2] * d[0]};
    const T x = d[0] + 2.0 * (q[0] * c[0] + q[2] * c[2] - q[3] * c[1]);
    const T y = d[1] + 2.0 * (q[0] * c[1] + q[3] * c[0] - q[1] * c[2]);
    const T z = d[2] + 2.0 * (q[0] * c[2] + q[1] * c[1] - q[2] * c[0]);
    // A step that puts the point behind the camera is refused by the solver.
    if (!(z > 1e-9)) return false;
    const T xn = x / z, yn = y / z;
    T xd = xn, yd = yn;
    distort(camera->lens(), xn, yn, xd, yd);
    const Intrinsics& in = camera->intrinsics();
    residual[0] = (in.fx * xd + (in.cx - pixel.x)) / sigmaPx;
    residual[1] = (in.fy * yd + (in.cy - pixel.y)) / sigmaPx;
    return true;
  }
};

}  // namespace alidade
