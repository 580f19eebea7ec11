// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

struct FeatureTrackOptions {
  int atMost = 300;           ///< corners
  double widestPx = 1280;     ///< pictures are shrunk to this width first
  double thereAndBackPx = 0.5;  ///< a track that does not come back to within this, after the shrinking, is dropped
};

/// Places in `first` and where they are in `second`: corners (Shi and Tomasi 1994) followed by Lucas and Kanade's
/// method on pyramids (Bouguet 2001), there and back again. Pixels of the full pictures, OpenCV's origin; spread
/// over the picture. Empty where there is nothing to follow. Error where the sizes differ.
Result<std::vector<std::pair<glm::dvec2, glm::dvec2>>> trackFeatures(const ColourImage& first, const ColourImage& second,
                                                                     const FeatureTrackOptions& options = {});

}  // namespace alidade
