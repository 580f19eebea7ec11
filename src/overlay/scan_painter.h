// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <memory>

#include "base/image.h"
#include "camera/camera.h"
#include "overlay/frame_description.h"
#include "raster/splat_device.h"

namespace alidade {

/// What the scans give for one frame, of the camera's size.
struct ScanPictures {
  DepthImage depth;    ///< occlusion depth: see raster/occlusion.h
  ColourImage colour;  ///< the points as styled; empty where they are not shown
  std::uint64_t total = 0, drawn = 0;  ///< points of all scans, and those that the density chose
};

/// Draws a frame's scans: what hides the design, and the points themselves where they are shown. Keeps
/// styled points between frames. One user at a time.
class ScanPainter {
 public:
  ScanPainter();
  ~ScanPainter();

  /// `device` draws the shown points in the processor's place where it is given.
  ScanPictures draw(const FrameDescription& frame, const Camera& camera, SplatDevice* device = nullptr);

 private:
  PointStyler& stylerOf(const ScanPoints& points);
  DepthImage occlusion(const FrameDescription& frame, const Camera& camera);

  std::map<const PointStore*, std::unique_ptr<PointStyler>> m_stylers;
};

}  // namespace alidade
