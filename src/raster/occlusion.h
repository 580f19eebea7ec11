// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"
#include "camera/camera.h"
#include "raster/splatter.h"

namespace alidade {

/// Depth of the scanned *surfaces* as the camera sees them. +inf: the scan sees through here (never
/// produced without support); NaN: unknown, nothing scanned supports this pixel.
struct OcclusionDepth {
  DepthImage depth;
  std::uint64_t pointsDrawn = 0;
};

/// From dots to surfaces: points of 1 px, those that a nearer surface hides removed, then holes
/// filled where the neighbours agree (edge-aware push-pull, planar in 1/z). What it cannot support
/// stays NaN.
OcclusionDepth occlusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                              const RigidTransform& cameraFromWorld);

/// What the scan says of a point at depth `z` behind pixel (x, y).
enum class Visibility { Visible, Hidden, Unknown, Outside };

/// Visible where z <= depth + tolerance (absolute metres plus 0.05 % of z), Hidden behind it, Unknown
/// where the depth is NaN, Outside beyond the picture.
Visibility visibilityAt(const DepthImage& occlusion, const glm::dvec2& pixel, double z, double toleranceM);

}  // namespace alidade
