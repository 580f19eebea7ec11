// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "base/image.h"
#include "camera/camera.h"
#include "overlay/frame_description.h"
#include "raster/point_painter.h"
#include "raster/splat_device.h"

namespace alidade {

/// What the scans give for one frame, of the camera's size.
struct ScanPictures {
  DepthImage depth;    ///< occlusion depth: see raster/occlusion.h
  ColourImage colour;  ///< the points as styled; empty where they are not shown
  std::uint64_t total = 0;   ///< points of all scans
  std::uint64_t chosen = 0;  ///< that density and budget chose
  std::uint64_t drawn = 0;   ///< of those, what classes, box and section leave
  std::uint64_t judged = 0;  ///< that tell what hides
};

/// Draws a frame's scans: what hides the design, and the points themselves where they are shown. Keeps
/// styled points between frames. One user at a time.
class ScanPainter {
 public:
  ScanPainter();
  explicit ScanPainter(PointPainter::Clock clock);
  ~ScanPainter();

  /// `device` draws the shown points in the processor's place where it is given.
  ScanPictures draw(const FrameDescription& frame, const Camera& camera, SplatDevice* device = nullptr);

 private:
  DepthImage occlusion(const FrameDescription& frame, const std::vector<ScanLayer>& scans, const Camera& camera,
                       std::uint64_t& judged);
  DepthImage quickOcclusion(const FrameDescription& frame, const Camera& camera, std::uint64_t& judged);

  PointPainter m_points;
};

}  // namespace alidade
