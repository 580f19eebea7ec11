// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "raster/cell_normals.h"
#include "raster/level_surface.h"
#include "raster/splat_device.h"
#include "raster/splat_kernel.h"
#include "raster/splatter.h"

namespace alidade {

/// One selected range ready to draw.
struct SplatRun {
  const DisplayPoint* points = nullptr;
  std::uint32_t count = 0;
  std::uint32_t payloadBase = 0;
  double spacing = 0;  ///< that its footprints follow, node steps; 0: they are of one size in the world or on screen
  glm::dvec3 boxMiddle{0};  ///< of its node's points, in the camera's frame, metres
  glm::dmat3 boxHalf{0};    ///< columns: half the box's edges there
  double nearest = 0;       ///< depth, see nearestDepth()
  SplatView view;
};

/// Makes rows [first, last) of the picture of what was drawn; `coarse`: the surface of level 1, null where there is none.
template <class Pixel>
using MergeRows = std::function<void(const SplatPlanes<Pixel>& planes, const SplatLevels& levels, const LevelSurface* coarse, int first, int last)>;

/// Smallest depth that a point of the box can have, metres; 0 where the box reaches the eye's plane.
double nearestDepth(const Bounds& bounds, const RigidTransform& cameraFromWorld);

/// The camera's and the footprint's part of the view; runs of one node add m, t and the size. Refers to
/// the camera, which must outlive the drawing.
SplatView baseView(const Camera& camera, const SplatOptions& options);

SurfacePayload surfacePayloadOf(SplatPayload payload);

/// Whether points of more than a pixel fall into levels; else they are footprints.
bool usesLevels(const SplatOptions& options);

/// The range's points, seen by the camera: the double sums of origin and pose done here.
SplatRun makeRun(const PointStore& store, const SelectedRange& range, const RigidTransform& cameraFromWorld,
                 const SplatView& base, const SplatOptions& options);

/// How a frame's runs are drawn.
struct SplatDrawing {
  SplatPayload payload = SplatPayload::None;
  bool closeHoles = false;
  /// Where footprints of more than a pixel lie in the surface, which is fitted to the runs that need it: the pose that these
  /// were made with. Null: they face the eye.
  const RigidTransform* onSurface = nullptr;
  /// Points that are farther apart than a pixel fall into coarser levels, and what HiddenTiles finds hidden is left out.
  bool intoLevels = false;
};

/// Draws the runs on all cores, one private plane a thread, which draws what lies together in the picture, then has `merge` make the picture of them in
/// bands of rows [first, last), on all cores too. payload None draws 32-bit pixels and calls the
/// first; anything else 64-bit ones and the second. A device draws the runs that need no domain check.
void drawRuns(
    std::span<SplatRun> runs, int width, int height, const SplatDrawing& drawing,
    const MergeRows<std::uint32_t>& mergeDepth, const MergeRows<std::uint64_t>& mergePacked,
    SplatDevice* device = nullptr);

}  // namespace alidade
