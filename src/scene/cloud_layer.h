// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <vector>

#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "raster/point_painter.h"
#include "scene/layer_hit.h"
#include "scene/picture_prop.h"

namespace alidade {

/// The scans of the 3D view, drawn by the point engine as the picture's are: chosen for each view anew, as dense as the screen
/// can show, and handed to VTK as a picture with depths.
class CloudLayer {
 public:
  explicit CloudLayer(vtkRenderer* renderer);

  void set(const std::vector<ScanPoints>& clouds);
  void setDisplay(const DisplaySettings& display);
  /// Of footprints and of the smallest point: what a logical pixel has in device pixels.
  void setPixelRatio(double ratio);

  /// Makes the picture for this view; what was made is kept while nothing changes. Of a moving view at most `budget` points (0: all).
  void draw(const ViewCamera& camera, std::uint64_t budget);

  Bounds bounds() const;
  /// Points that a still picture of this view shows.
  std::uint64_t countFor(const ViewCamera& camera);
  /// Points of the last picture.
  std::uint64_t drawnCount() const { return m_points.drawn; }
  /// The nearest of the points that a picture shows, within `radiusPx` of the cursor.
  std::optional<LayerHit> hit(const ViewCamera& camera, const glm::dvec2& px, double radiusPx);

 private:
  struct View {
    ViewCamera camera;
    std::uint64_t budget = 0;
    friend bool operator==(const View&, const View&) = default;
  };
  void choose(const View& view);

  std::vector<ScanPoints> m_clouds;
  DisplaySettings m_display;
  double m_ratio = 1;
  PointPainter m_painter;
  ChosenPoints m_points;
  std::optional<View> m_chosenFor, m_drawnFor;  ///< nothing: neither holds any more
  vtkSmartPointer<PictureProp> m_picture;
};

}  // namespace alidade
