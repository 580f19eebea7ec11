// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "simulate/site_mesh.h"

namespace alidade {

/// A rectangle in a profile's plane.
struct ProfileRectangle {
  glm::dvec2 low{0.0}, high{0.0};
};

/// A flat profile, extruded along its plane's normal: every element of the design is one, as
/// IfcExtrudedAreaSolid wants it. A point (x, y, z) of the prism's own frame, 0 <= z <= depth, lies at
/// `origin + axes * (x, y, z)` in the site frame; axes are right-handed and orthonormal.
///
/// Either a rectangle with rectangular openings (an opening that touches the lower or the upper edge becomes
/// a notch), or a circle's regular polygon.
struct Prism {
  glm::dvec3 origin{0.0};
  glm::dmat3 axes{1.0};
  double depth = 0;
  ProfileRectangle outline;
  std::vector<ProfileRectangle> openings;
  double circleRadius = 0;  ///< > 0: the profile is a circle about (0,0), drawn with circleSides
  static constexpr int circleSides = 24;

  glm::dvec3 at(const glm::dvec3& p) const { return origin + axes * p; }

  /// The outer contour, counter-clockwise, with notches; and the holes, clockwise.
  std::vector<glm::dvec2> contour() const;
  std::vector<std::vector<glm::dvec2>> holes() const;

  /// Appends the faces to the current object; conforming, without T-junctions.
  void addTo(SiteMesh& mesh) const;
};

}  // namespace alidade
