// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "cloud/point_store.h"
#include "cloud/selection.h"
#include "geometry/rigid_transform.h"
#include "raster/reciprocal.h"

namespace alidade {

/// One store's share of a frame.
struct SplatLayer {
  std::shared_ptr<const PointStore> store;
  Selection selection;
};

class SplatDevice;

struct SplatOptions {
  bool colour = false;     ///< fill SplatImages::colour
  bool ids = false;        ///< fill SplatImages::point; surfaces' depths are then those of their cells' nearest points, a little too near on slopes
  /// User's factor on the automatic size: cells of a level at least as wide as points are apart, or footprints as wide as it takes to
  /// close the surface, 1.5 s - 0.5 pixels where points are s pixels apart, at least one.
  double pointSize = 1.0;
  double minimumSizePx = 1.0;
  double maximumSizePx = 32.0;
  bool round = false;
  /// Footprints lie in the surface's plane where the points of a node show one: 1/z linear over the
  /// footprint, foreshortened along it. Otherwise, and for fixedSize, they face the eye at their point's
  /// depth.
  bool planar = true;
  /// Pixels that the points of a surface missed are closed, see raster/level_surface.h; not where points are drawn smaller
  /// than they are apart, at one pixel or at a fixed size.
  bool closeHoles = true;
  /// Points that are drawn at least as wide as they are apart make a surface, put together from levels (see
  /// raster/level_surface.h) and not of footprints; but for round ones, and those of a fixed size or of one in the world.
  bool surface = true;
  /// Every point this wide in the world, metres, before `pointSize`: Zhang (2020), whose s n r H / (z
  /// tan(fov/2)) is s w f / z with w = n r H / (f tan(fov/2)). 0: as wide as its neighbours are apart.
  double worldSizeM = 0;
  /// MultiplyAdd: in nodes where it moves no point by more than `reciprocalErrorPx` (Vázquez and Antelo).
  Reciprocal reciprocal = Reciprocal::Division;
  double reciprocalErrorPx = 0.05;
  bool fixedSize = false;  ///< Gantner (2018): pointSize is the size in pixels for every point
  /// Draws what it can in the processor's place: the same picture but for what its arithmetic rounds over a
  /// pixel's border. One that fails is logged, and the processor draws.
  SplatDevice* device = nullptr;
};

/// What the points give for one camera; all of the camera's size.
struct SplatImages {
  DepthImage depth;    ///< z along the optical axis, metres; +inf where no point falls
  ColourImage colour;  ///< a = 0 where no point falls
  /// 1 + the point's index over all layers in order (layer 0's points first); 0 where none.
  Image<std::uint64_t> point;
  std::uint64_t drawn = 0;
};

/// Draws the selected points through the camera's full lens, nearest wins. Vectorised (AVX-512, AVX2
/// or scalar, chosen at run time) and threaded.
SplatImages splat(const std::vector<SplatLayer>& layers, const Camera& camera,
                  const RigidTransform& cameraFromWorld, const SplatOptions& options);

/// "AVX-512", "AVX2" or "scalar"; ALIDADE_SIMD=avx2|scalar forces a slower one.
const char* splatKernelName();

}  // namespace alidade
