// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <bitset>
#include <vector>

#include <glm/glm.hpp>

namespace alidade {

/// What gives a scan point its colour on screen.
enum class ColourBy { Rgb, Intensity, Height, Classification, Return, GpsTime, Scan, Distance, Normal };

/// How a number becomes a colour. Each ramp is readable for colour-blind eyes.
enum class ColourRamp { Viridis, Cividis, Grey };

/// How large a point is drawn.
enum class PointSizeLaw {
  Spacing,  ///< as wide as its neighbours are apart, so that surfaces close
  Screen,   ///< Zhang (2020): the same width in the world for all, the coarsest scan's median spacing
  Fixed,    ///< Gantner (2018): the same number of pixels for all
};

/// A box upright in the world, turned about the vertical. Points outside are left out.
struct ClipBox {
  bool on = false;
  glm::dvec3 centre{0};  ///< world, metres
  glm::dvec3 size{10};   ///< along its own x, y, z, metres
  double headingRad = 0;  ///< of its y axis, clockwise from north

  friend bool operator==(const ClipBox&, const ClipBox&) = default;
};

/// A slab between two parallel planes, or all that lies behind one.
struct Section {
  bool on = false;
  glm::dvec3 point{0};       ///< in the middle of the slab, world, metres
  double azimuthRad = 0;     ///< of its normal, clockwise from north
  double elevationRad = 0;   ///< of its normal, above the horizon
  double thicknessM = 0.1;   ///< 0: everything behind the plane, against the normal

  glm::dvec3 normal() const;
  friend bool operator==(const Section&, const Section&) = default;
};

/// Cuts off what lies in front of a plane, on the side that its normal points to.
struct CutPlane {
  bool on = true;
  glm::dvec3 point{0};      ///< on the plane, world, metres
  double azimuthRad = 0;    ///< of its normal, clockwise from north
  double elevationRad = 0;  ///< of its normal, above the horizon

  glm::dvec3 normal() const;
  friend bool operator==(const CutPlane&, const CutPlane&) = default;
};

/// Points with dot(normal, p) >= offset stay.
struct ClipPlane {
  glm::dvec3 normal{0, 0, 1};  ///< world, unit
  double offset = 0;           ///< metres
};

/// Which scan points are used, and how they look. What is left out here neither shows nor hides
/// the design, unlike what the density slider leaves out.
struct PointStyle {
  ColourBy colourBy = ColourBy::Rgb;
  ColourRamp ramp = ColourRamp::Viridis;
  bool automaticRange = true;  ///< from the 1st to the 99th percentile of the values
  double rangeLow = 0, rangeHigh = 1;  ///< in the value's own unit, where not automatic

  std::bitset<256> hiddenClasses;  ///< ASPRS LAS 1.4 R15, table 17
  ClipBox clipBox;
  Section section;
  std::vector<CutPlane> cuts;  ///< each cuts what the others leave

  PointSizeLaw sizeLaw = PointSizeLaw::Spacing;
  bool eyeDome = false;  ///< Eye-Dome lighting (Boucheny 2009): depth steps darken
  double eyeDomeStrength = 1.0;

  /// Box, section and cuts as planes.
  std::vector<ClipPlane> clipPlanes() const;
  bool filters() const;

  friend bool operator==(const PointStyle&, const PointStyle&) = default;
};

}  // namespace alidade
