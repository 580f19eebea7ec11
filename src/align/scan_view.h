// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "cloud/point_store.h"
#include "geometry/rigid_transform.h"
#include "raster/occluder_mesh.h"

namespace alidade {

/// What is known of the site in three dimensions: pictures are aligned to it.
struct AlignmentScene {
  std::vector<std::shared_ptr<const PointStore>> scans;
  std::vector<std::shared_ptr<const OccluderMesh>> surfaces;  ///< of the scanners' grids

  /// The surfaces are all there is, as a design has them: where none is, one sees far beyond. Else nothing is known there.
  bool complete = false;

  bool empty() const { return scans.empty() && surfaces.empty(); }
  /// Some scan holds colours or intensities.
  bool hasColour() const;
  /// The coarsest scan's median spacing, metres; 0 without a scan.
  double spacingM() const;
};

/// What the scene looks like from a pose, through the camera's lens.
struct ScanView {
  bool ofEdges = false;            ///< luma is the strength of edges: the scene has no colours
  Image<float> luma;               ///< 0..255, interpolated between points; meaningless where not covered
  Image<std::uint8_t> covered;     ///< 1 where points lie so dense that luma stands on them
  DepthImage depth;                ///< metres along the axis; NaN where unknown
  double coverage = 0;             ///< share of covered pixels
};

/// Draws points without the shift that "nearest point wins" gives to what is seen at a slant: each visible point
/// spreads its brightness over the four pixels around its exact place, then pixels between points take that of
/// their surroundings (pull-push, Gortler et al., The Lumigraph, 1996). Visible is what lies on the occlusion
/// depth of raster/. A scene without colours and intensities is drawn as the edges of its surfaces, depthEdges().
ScanView drawScanView(const AlignmentScene& scene, const Camera& camera, const RigidTransform& cameraFromWorld);

}  // namespace alidade
