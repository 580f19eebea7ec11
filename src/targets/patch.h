// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

/// Luma of ITU-R BT.601, 0..255.
inline float greyOf(const Rgba8& c) {
  return 0.299f * c.r + 0.587f * c.g + 0.114f * c.b;
}

/// A square cut of a picture as grey values. Its pixel (0,0) lies at `origin` of the picture.
struct Patch {
  int side = 0;
  glm::dvec2 origin{0};
  std::vector<float> grey;

  float at(int x, int y) const { return grey[static_cast<std::size_t>(y) * side + x]; }
  bool holds(const glm::dvec2& pixel, double margin = 0) const;
  /// Bilinear; `pixel` is of the picture and inside.
  double sample(const glm::dvec2& pixel) const;
};

/// The pixels at most `reach` from the one that `about` falls into. Error where they leave the picture.
Result<Patch> cutPatch(const ColourImage& picture, const glm::dvec2& about, int reach);

/// Derivatives in x and y, grey values a pixel.
struct Gradients {
  int side = 0;
  glm::dvec2 origin{0};
  std::vector<glm::dvec2> values;
  const glm::dvec2& at(int x, int y) const { return values[static_cast<std::size_t>(y) * side + x]; }
};

/// Derivatives of a Gaussian of one pixel, at most `reach` from the pixel that `about` falls into.
Result<Gradients> gradientsAround(const ColourImage& picture, const glm::dvec2& about, int reach);

}  // namespace alidade
