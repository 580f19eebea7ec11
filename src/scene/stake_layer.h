// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include <vtkBillboardTextActor3D.h>
#include <vtkRenderer.h>

#include "scene/layer_hit.h"
#include "scene/polydata.h"

namespace alidade {

/// Stake-out points of the 3D view: a marker of constant size on screen, a tolerance circle of true
/// size, and a name where there is room for it.
class StakeLayer {
 public:
  explicit StakeLayer(vtkRenderer* renderer);

  void set(const std::vector<StakePoint>& points) { m_points = points; }
  void build(const glm::dvec3& origin);
  void select(const std::string& name);
  void setScale(double devicePixelRatio);
  /// Chooses the names that do not cover each other; before every picture.
  void placeLabels(const ViewCamera& camera);

  Bounds bounds() const;
  std::optional<LayerHit> hit(const ViewCamera& camera, const glm::dvec2& px) const;

 private:
  void buildSelection();
  vtkBillboardTextActor3D* label(std::size_t index);

  vtkRenderer* m_renderer;
  std::vector<StakePoint> m_points;
  std::string m_selected;
  glm::dvec3 m_origin{0};
  double m_scale = 1;
  LitActor m_markers, m_circles, m_selection;
  std::vector<vtkSmartPointer<vtkBillboardTextActor3D>> m_labels;  ///< a pool, reused
};

}  // namespace alidade
