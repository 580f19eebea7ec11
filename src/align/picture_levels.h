// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "camera/rolling_shutter.h"

namespace alidade {

/// A photo's brightness (0..255) at one size, and the lens at that size.
struct PictureLevel {
  Camera camera;
  Image<float> luma;
  double scale = 1;  ///< pixels of the raw picture a pixel of this level
  RollingShutter shutter = {};
};

/// Between the four pixels around; beside the image its border's. At least two pixels a side.
inline float sampled(const Image<float>& image, const glm::dvec2& at) {
  const int x = std::clamp(static_cast<int>(at.x), 0, image.width() - 2), y = std::clamp(static_cast<int>(at.y), 0, image.height() - 2);
  const auto a = static_cast<float>(std::clamp(at.x - x, 0.0, 1.0)), b = static_cast<float>(std::clamp(at.y - y, 0.0, 1.0));
  return (1 - b) * ((1 - a) * image.at(x, y) + a * image.at(x + 1, y)) + b * ((1 - a) * image.at(x, y + 1) + a * image.at(x + 1, y + 1));
}

/// The photo at widths halved from `finestWidth` (at most the photo's own) down to `coarsestWidth` or a little more; coarsest
/// first. Pixels are means over those of the photo.
std::vector<PictureLevel> picturePyramid(const ColourImage& photo, const Camera& camera, int finestWidth, int coarsestWidth);

}  // namespace alidade
