// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

// A pick made exact: a click is good to a pixel, a corner or the centre of a target to a few hundredths.

enum class MarkShape {
  Corner,  ///< edges that meet: a corner, a crossing, a chessboard's saddle
  Centre,  ///< of a disc, a ring, a target with rings
};

struct MarkOptions {
  double radiusPx = 7;      ///< of what is looked at around the mark (two standard deviations of its weights)
  double farthestPx = 5;    ///< between the pick and the mark
  Result<void> validate() const;
};

/// A mark in a picture; pixels have OpenCV's origin.
struct Mark {
  glm::dvec2 pixel{0};
  double sigmaPx = 0;  ///< one standard deviation on an axis, from how well the gradients agree: blur counts as
                             ///< disagreement, so rather too large than too small
  MarkShape shape = MarkShape::Corner;
};

/// The corner or target centre next to a pick. The point that the lines of all edges in the window pass through is a
/// corner, the one that their normals pass through a centre; the one that fits better is given (Förstner and Gülch, A
/// fast operator for detection and precise location of distinct points, corners and centres of circular features, 1987).
/// Error where the window leaves the picture, where it shows nothing but noise or one edge, or where what it shows
/// lies farther from the pick than `farthestPx`.
Result<Mark> refineMark(const ColourImage& picture, const glm::dvec2& pick, const MarkOptions& options = {});

}  // namespace alidade
