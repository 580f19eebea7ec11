// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <vtkRenderer.h>
#include <vtkStaticCellLocator.h>

#include "scene/layer_hit.h"
#include "scene/polydata.h"

namespace alidade {

/// The designs of the 3D view: faces and edges of the visible elements, and the selected element
/// drawn over them.
class SceneDesignLayer {
 public:
  explicit SceneDesignLayer(vtkRenderer* renderer);
  ~SceneDesignLayer();

  void set(const std::vector<SceneDesign>& designs) { m_designs = designs; }
  void build(const glm::dvec3& origin);
  void select(DesignId design, int element);
  void setLineScale(double devicePixelRatio);

  /// Of the visible elements.
  Bounds bounds() const { return m_bounds; }
  std::optional<LayerHit> hit(const ViewCamera& camera, const glm::dvec2& px) const;

 private:
  struct Part {
    DesignId id;
    std::vector<int> elementOfTriangle;
    vtkSmartPointer<vtkPolyData> faces;
    vtkSmartPointer<vtkStaticCellLocator> locator;
    LitActor opaque, clear, edges;
  };
  void addPart(const SceneDesign& design);
  void clearParts();
  void buildSelection();

  vtkRenderer* m_renderer;
  std::vector<SceneDesign> m_designs;
  std::vector<Part> m_parts;
  glm::dvec3 m_origin{0};
  Bounds m_bounds;
  DesignId m_selectedDesign;
  int m_selectedElement = -1;
  double m_lineScale = 1;
  LitActor m_selectedFaces, m_selectedEdges;
};

}  // namespace alidade
