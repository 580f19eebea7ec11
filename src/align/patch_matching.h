// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "base/image.h"

namespace alidade {

/// A square of a drawn picture that is looked for in a photo of the same size: brightness with its mean taken off,
/// zero where the drawing shows nothing.
struct Patch {
  glm::ivec2 at{0};  ///< centre
  int half = 7;      ///< reaches so many pixels to each side
  std::vector<float> light, weight;
  float norm = 0;    ///< root of the sum of squares
  float weightSum = 0;
};

/// Centres of patches with texture in two directions, the best of each cell of a grid: the smaller eigenvalue of
/// the gradients' matrix (Shi and Tomasi 1994). Only where four fifths of the patch are covered.
std::vector<Patch> choosePatches(const Image<float>& drawn, const Image<std::uint8_t>& covered, int half, int cellPx);

/// Normalised cross-correlation, -1..1, of a patch with the photo at each displacement within ±radius; -1 where the
/// patch leaves the photo. Row by row, displacement (0, 0) in the middle.
Image<float> correlate(const Patch& patch, const Image<float>& photo, int radius, const glm::ivec2& around = {0, 0});

/// Where a patch lies in the photo.
struct PatchPlace {
  glm::dvec2 pixel{0};
  double correlation = 0;
  double sigmaPx = 0;  ///< of the worse direction, from the gradients and what the fit leaves
  glm::dmat2 information{0};  ///< inverse covariance of the pixel: along a straight edge there is none
};

/// From the best displacement within ±radius to a part of a pixel: least squares over shift, gain and offset (Lucas
/// and Kanade 1981). Nothing where the correlation stays below `least`, the best place lies on the search's border, or
/// another place is as good. `around`: displacement at which the search stands.
std::optional<PatchPlace> findPatch(const Patch& patch, const Image<float>& photo, int radius, double least,
                                    const glm::ivec2& around = {0, 0});

/// The same for a pose that is nearly right: the nearer of two equal places is taken, so that a patch on a straight edge
/// counts across it.
std::optional<PatchPlace> followPatch(const Patch& patch, const Image<float>& photo, int radius, double least,
                                      const glm::ivec2& around = {0, 0});

}  // namespace alidade
