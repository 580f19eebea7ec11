// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"
#include "camera/camera.h"
#include "raster/occluder_mesh.h"
#include "raster/splatter.h"

namespace alidade {

/// Depth of the scanned *surfaces* as the camera sees them. +inf: the scan sees through here (never
/// produced without support); NaN: unknown, nothing scanned supports this pixel.
struct OcclusionDepth {
  DepthImage depth;
  /// Of the layers: what is denser than four points a pixel is drawn in part.
  std::uint64_t pointsDrawn = 0;
};

/// What hides the design. Scans with a scanner's grid come as meshes; the points of the others as layers.
struct Occluders {
  std::vector<SplatLayer> layers;
  std::vector<std::shared_ptr<const OccluderMesh>> meshes;
};

/// The nearer of both kinds a pixel; what neither supports stays NaN.
///
/// Layers, from dots to surfaces: points of 1 px, those that a nearer surface hides removed, then holes
/// filled where the neighbours agree (edge-aware push-pull, planar in 1/z). Meshes: see drawMeshes().
OcclusionDepth occlusionDepth(const Occluders& occluders, const Camera& camera,
                              const RigidTransform& cameraFromWorld);
OcclusionDepth occlusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                              const RigidTransform& cameraFromWorld);

/// For comparison only: every point a square of `sizePx` pixels at its own depth (Gantner 2018 with 3).
OcclusionDepth squareOcclusionDepth(const std::vector<SplatLayer>& layers, const Camera& camera,
                                    const RigidTransform& cameraFromWorld, double sizePx = 3.0);

/// What the scan says of a point at depth `z` behind pixel (x, y).
enum class Visibility { Visible, Hidden, Unknown, Outside };

/// Visible where z <= depth + tolerance (absolute metres plus 0.05 % of z), Hidden behind it, Unknown
/// where the depth is NaN, Outside beyond the picture.
Visibility visibilityAt(const DepthImage& occlusion, const glm::dvec2& pixel, double z, double toleranceM);

}  // namespace alidade
