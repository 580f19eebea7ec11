// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

struct MarkMatchOptions {
  int radiusPx = 12;             ///< of the patch that is looked for
  int searchPx = 40;             ///< at most this far from where it is expected, on each axis
  double leastCorrelation = 0.75;
  Result<void> validate() const;
};

/// The place in another picture that shows what `at` shows in `reference`.
struct MarkMatch {
  glm::dvec2 pixel{0};     ///< OpenCV's origin
  double sigmaPx = 0;      ///< one standard deviation on an axis
  double correlation = 0;  ///< of the two patches once they lie on each other, -1..1
};

/// Looks for the patch around `at` near `expected`: normalised cross-correlation finds the pixel, least-squares matching
/// with an affine patch and free brightness and contrast the fraction (Gruen, Adaptive least squares correlation, 1985).
/// `shape` is the patch's expected 2×2 change of shape, d picture / d reference: a nearer camera shows it larger.
/// Error where a patch leaves its picture, where nothing correlates well enough, or where two places do.
Result<MarkMatch> matchMark(const ColourImage& reference, const glm::dvec2& at, const ColourImage& picture,
                            const glm::dvec2& expected, const glm::dmat2& shape = glm::dmat2(1),
                            const MarkMatchOptions& options = {});

}  // namespace alidade
