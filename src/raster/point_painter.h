// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "camera/camera.h"
#include "cloud/point_styler.h"
#include "geometry/rigid_transform.h"
#include "raster/splatter.h"
#include "survey/display_settings.h"

namespace alidade {

struct PointView {
  Camera camera;
  RigidTransform cameraFromWorld;
  // While the view moves (cloud/frame_pacer.h):
  std::uint64_t pointBudget = 0;  ///< over all scans; 0: none
  double selectionAgeMs = 0;      ///< points chosen for an earlier view may serve this one for so long
};

/// Which points of the scans are drawn for a view, as their display settings ask.
struct ChosenPoints {
  std::vector<SplatLayer> layers;  ///< one a scan
  std::uint64_t chosen = 0;        ///< that density and budget chose
  std::uint64_t drawn = 0;         ///< of those, what classes, box and section leave
};

/// Chooses, styles and splats the points of scans: the same in the picture and in the 3D view. Keeps styled points
/// from view to view. One user at a time.
class PointPainter {
 public:
  using Clock = std::function<double()>;  ///< milliseconds
  PointPainter();
  explicit PointPainter(Clock clock);
  ~PointPainter();

  /// The ranges are valid until the next call. Scans that are no longer among `scans` are forgotten.
  ChosenPoints choose(const std::vector<ScanPoints>& scans, const DisplaySettings& display, const PointView& view,
                      PointStyler::Part part = PointStyler::Part::ColourAndFilter);

  /// `device` draws in the processor's place where it is given.
  SplatImages draw(const ChosenPoints& points, const DisplaySettings& display, const PointView& view, SplatDevice* device = nullptr) const;

  PointStyler& stylerOf(const ScanPoints& scan);

 private:
  const std::vector<Selection>& selectionsFor(const std::vector<ScanPoints>& scans, const DisplaySettings& display, const PointView& view);

  Clock m_clock;
  std::map<const PointStore*, std::unique_ptr<PointStyler>> m_stylers;
  /// The points selected for a view, and of which scans.
  std::vector<std::shared_ptr<const PointStore>> m_stores;
  std::vector<Selection> m_selections;
  double m_selectedAt = 0;
};

}  // namespace alidade
