// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <vector>

#include <vtkRenderer.h>

#include "cloud/point_styler.h"
#include "scene/layer_hit.h"
#include "scene/polydata.h"

namespace alidade {

/// The scans of the 3D view: two clouds of vertices, a coarse one that is always drawn and a fine
/// one that is drawn when the view stands still. Which points is decided by their continuous level
/// alone, so that the picture is evenly thinned and a coarser one is part of a finer one.
class CloudLayer {
 public:
  explicit CloudLayer(vtkRenderer* renderer);

  void set(const std::vector<ScanPoints>& clouds);
  /// Picks the points: density 0..1 of min(all, budget), then styled. Call after set() and when the origin moves.
  void build(const glm::dvec3& origin, double density, std::uint64_t budget, const PointStyle& style);
  void setPointSize(double pixels);
  void setMoving(bool moving);

  Bounds bounds() const;
  std::uint64_t drawnCount() const { return m_points.size(); }
  /// The nearest point within `radiusPx` of the cursor.
  std::optional<LayerHit> hit(const ViewCamera& camera, const glm::dvec2& px, double radiusPx) const;

 private:
  struct Cloud {
    ScanPoints points;
    std::unique_ptr<PointStyler> styler;
  };
  struct Range {
    std::size_t firstDrawn;  ///< into m_points
    std::size_t cloud;
    std::uint32_t node;
  };
  void addPoints(double fromShare, double toShare, const PointStyle& style);
  glm::dvec3 positionOf(std::size_t drawn) const;

  std::vector<Cloud> m_clouds;
  glm::dvec3 m_origin{0};
  std::vector<glm::vec3> m_points;  ///< drawn ones, relative to m_origin; coarse ones first
  std::vector<glm::u8vec3> m_colours;
  std::vector<Range> m_ranges;  ///< ascending by firstDrawn
  LitActor m_coarse, m_fine;
};

}  // namespace alidade
