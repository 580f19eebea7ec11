// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <span>

#include <glm/glm.hpp>

namespace alidade {

/// Two parallel planes with nearly all points of a node between them: how flat its surface is, and which way it faces.
struct NodeSlab {
  glm::vec3 normal{0};  ///< of unit length, either side; zero: not known
  float along = 0;      ///< of the middle plane: normal · p = along
  float thickness = 0;  ///< between the planes, in the points' unit
  float roughness = 1;  ///< thickness by the points' breadth across it, at most 1; or what is open in it, if that is more
  float area = 0;       ///< of the rectangle in it that points spread so would fill, the points' unit squared
};

/// Of places that are spread over the node evenly. Their principal axes: the planes lie two standard deviations from their centre
/// along the least, the breadth is that of an even spread along the middle one. Too few tell nothing.
NodeSlab slabOf(std::span<const glm::vec3> places);

/// Railings and fences lie in a plane, too, but their bars face every way: a slab of which points cover less than all is as rough as the
/// share of it that is open. `covered`: the area of the surface that the points lie on, the points' unit squared.
void openUp(NodeSlab& slab, double covered);

/// How much of its area a node's surface shows to an eye at `eye`, relative to the frame of its slab, whose nearest point of the
/// node lies `distance` away: the cosine of the angle at which it is seen, or what the roughest and nearest of it may show. In
/// [kLeastFacing, 1].
double facingOf(const NodeSlab& slab, const glm::dvec3& eye, double distance);

/// Small things on a surface seen at a grazing angle may face the eye: they are left with points twice as far apart, no more.
constexpr double kLeastFacing = 0.25;

}  // namespace alidade
