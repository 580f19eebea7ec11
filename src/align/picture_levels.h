// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "base/image.h"
#include "camera/camera.h"

namespace alidade {

/// A photo's brightness (0..255) at one size, and the lens at that size.
struct PictureLevel {
  Camera camera;
  Image<float> luma;
  double scale = 1;  ///< pixels of the raw picture a pixel of this level
};

/// The photo at widths halved from `finestWidth` (at most the photo's own) down to `coarsestWidth` or a little more; coarsest
/// first. Pixels are means over those of the photo.
std::vector<PictureLevel> picturePyramid(const ColourImage& photo, const Camera& camera, int finestWidth, int coarsestWidth);

}  // namespace alidade
