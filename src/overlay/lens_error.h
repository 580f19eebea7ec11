// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "camera/camera.h"

namespace alidade {

/// A point in camera axes (metres) with its place (X/Z, Y/Z) on the undistorted image plane.
struct LensPoint {
  glm::dvec3 p{0, 0, 1};
  glm::dvec2 n{0};
  static LensPoint of(const glm::dvec3& pInCamera) {
    return {pInCamera, glm::dvec2(pInCamera) / pInCamera.z};
  }
};

/// Halves the angle at the camera. Bit for bit the same for (a, b) and (b, a), so that triangles on both
/// sides of an edge split it at the same point.
LensPoint bisect(const LensPoint& a, const LensPoint& b);

/// Where a straight line in space ends up on a picture bent by the lens, and how far that is from the
/// straight line that a device draws: the measure behind every split, and the part of the image plane
/// outside of which nothing is drawn.
class LensError {
 public:
  static constexpr double kNearM = 0.05;  ///< near plane, metres

  LensError(const Camera& camera, double allowedPx);

  double allowedPx() const { return m_allowedPx; }

  /// Pixel through the lens, domain unchecked.
  glm::dvec2 pixel(const glm::dvec2& n) const;

  /// How far the straight line that a device draws from a to b is from the exact curve, in pixels, the
  /// largest of three places on it. The same for (a, b) and (b, a).
  struct Sag {
    double across = 0;  ///< from the curve to the line: what the eye sees of an edge
    double along = 0;   ///< shift of a point on the line: what the depth of a face is off by
  };
  Sag sag(const LensPoint& a, const LensPoint& b) const;

  /// An upper bound of both from the lens's curvature alone: costs nothing.
  double sagBound(const LensPoint& a, const LensPoint& b) const {
    const glm::dvec2 d = b.n - a.n;
    return m_curvature * glm::dot(d, d);
  }
  bool needsSplit(const LensPoint& a, const LensPoint& b) const {
    if (sagBound(a, b) <= m_allowedPx) return false;
    const Sag s = sag(a, b);
    return s.across > m_allowedPx || s.along > 2 * m_allowedPx;
  }

  /// True where the lens model holds: inside the fold-back radius and near enough to the picture.
  bool inside(const glm::dvec2& n) const {
    const double r2 = glm::dot(n, n);
    if (!(r2 <= m_radius * m_radius)) return false;
    return r2 <= m_safeRadius * m_safeRadius || m_camera.domain().contains(n.x, n.y);
  }
  double radius() const { return m_radius; }
  /// True where the whole circle of radius() is inside.
  bool isRound() const { return m_safeRadius >= m_radius; }
  /// True where the domain ends within the picture's reach, so that fragments must be masked as well.
  bool foldsInPicture() const { return m_foldsInPicture; }

  /// What the picture sees lies in this box of the undistorted image plane, with a margin.
  const glm::dvec2& low() const { return m_low; }
  const glm::dvec2& high() const { return m_high; }

 private:
  void findBox();
  void findCurvature();

  const Camera& m_camera;
  double m_allowedPx = 0.05;
  double m_radius = 0;
  double m_safeRadius = 0;
  bool m_foldsInPicture = false;
  double m_curvature = 0;  ///< pixels of sag per squared length on the image plane
  glm::dvec2 m_low{0}, m_high{0};
};

}  // namespace alidade
