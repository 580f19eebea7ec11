// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <vector>

#include <vtkRenderer.h>

#include "scene/layer_hit.h"
#include "scene/polydata.h"

namespace alidade {

/// Camera frusta and the trajectory of the 3D view. A frustum is a pyramid from the camera's centre
/// through the corners of its picture; its length suits the scene and has no meaning.
class FrameLayer {
 public:
  explicit FrameLayer(vtkRenderer* renderer);

  void set(const std::vector<SceneFrustum>& frames) { m_frames = frames; }
  void build(const glm::dvec3& origin, double sceneDiagonal);
  void setCurrent(FrameId frame);
  void setLineScale(double devicePixelRatio);

  const SceneFrustum* find(FrameId frame) const;
  Bounds bounds() const;
  std::optional<LayerHit> hit(const ViewCamera& camera, const glm::dvec2& px) const;

 private:
  /// Centre, then the four corners from the top left clockwise, then the tip of an up mark.
  struct Pyramid {
    std::size_t frame;
    std::array<glm::dvec3, 6> world;
  };
  Pyramid pyramidOf(std::size_t frame, double length) const;
  void buildCurrent();

  std::vector<SceneFrustum> m_frames;
  std::vector<Pyramid> m_shown;
  FrameId m_current;
  glm::dvec3 m_origin{0};
  double m_currentLength = 1;  ///< metres
  double m_lineScale = 1;
  LitActor m_pyramids, m_trajectory, m_currentPyramid;
};

}  // namespace alidade
