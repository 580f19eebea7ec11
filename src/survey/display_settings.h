// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "survey/point_style.h"

namespace alidade {

/// How parts of the design that the scan hides are drawn.
enum class HiddenStyle { Hide, Ghost, Dash };

/// Where the density slider's points come from: see cloud/selection.h.
enum class DensityLaw {
  PointsPerPixel,        ///< wanted spacing on screen; needs no tuning per data set
  PointsPerSquareMetre,  ///< Zhang (2020): D / ln(distance + 1)
};

/// Where a node's levels are cut.
enum class LevelThreshold {
  ByDistance,  ///< each node by its own distance from the eye
  ByPoint,     ///< each point by its own distance (Zhang 2020), so that no node's border shows; fewer are drawn
  Uniform,     ///< all nodes at the level that the nearest one wants (Zhang 2020, uniform threshold)
};

/// What of a frame is drawn, and how. Saved with the project; one struct for window and command line.
struct DisplaySettings {
  bool imagePass = true;
  bool depthPass = true;   ///< the scan hides the design
  bool designPass = true;
  bool pointPass = false;  ///< the scan's points in their own colour

  double density = 1.0;        ///< slider, 0..1: fraction of the wanted density; 0 draws nothing
  DensityLaw densityLaw = DensityLaw::PointsPerPixel;
  double pointsPerSquareMetre = 150000.0;  ///< D of Zhang (2020)
  LevelThreshold levelThreshold = LevelThreshold::ByDistance;
  double pointSize = 1.0;      ///< user's factor on the automatic point size
  bool roundPoints = false;
  PointStyle points;

  HiddenStyle hidden = HiddenStyle::Ghost;
  double designOpacity = 0.55;  ///< of visible surfaces; edges are opaque
  bool designEdges = true;
  bool designFaces = true;
  bool grayscaleImage = false;
  bool grayscaleDesign = false;  ///< Gantner (2018): a gray design over a gray camera

  glm::dvec3 lightDirection{-0.4, 0.5, -0.77};  ///< world, the way the light travels; unit not required
  double ambient = 0.35, diffuse = 0.65, specular = 0.25, shininess = 32.0;  ///< Blinn-Phong

  bool stakePoints = true;
  bool annotations = true;
  bool labels = true;
  double residualScale = 10.0;  ///< residual vectors of observations are drawn so many times as long

  double subdivisionErrorPx = 0.05;  ///< largest sag of a drawn edge against the lens's curve
  double depthToleranceM = 0.02;     ///< scan and design closer than this count as the same surface
};

}  // namespace alidade
