// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"

namespace alidade {

struct EyeDomeOptions {
  double strength = 1.0;  ///< 0: none; 1: a step of one part in three hundred darkens to about a third
  int radiusPx = 1;       ///< of the ring of eight neighbours that may shade a pixel, at least 1
};

/// The factor, 0..1, by which eye-dome lighting darkens a pixel (Boucheny 2009):
///
///     shade = exp(-300 strength · mean over eight neighbours of max(0, log2 z - log2 zNeighbour))
///
/// A pixel is darkened by neighbours nearer than itself, so that edges and steps show without normals. A
/// pixel without depth (infinite or NaN) stays 1 and shades no other; neighbours beyond the border do not shade.
Image<float> eyeDomeShade(const DepthImage& depth, const EyeDomeOptions& options);

/// Multiplies r, g and b; alpha stays. Both of one size.
void applyEyeDome(const DepthImage& depth, const EyeDomeOptions& options, ColourImage& colour);

}  // namespace alidade
