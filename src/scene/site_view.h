// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "camera/camera.h"
#include "cloud/point_store.h"
#include "geometry/rigid_transform.h"
#include "survey/design_model.h"
#include "survey/project.h"

class vtkGenericOpenGLRenderWindow;

namespace alidade {

struct SceneDesign {
  DesignId id;
  std::shared_ptr<const DesignModel> model;
  std::vector<std::uint8_t> elementVisible;  ///< empty: all
};

struct SceneFrustum {
  FrameId id;
  RigidTransform cameraFromWorld;
  Camera camera;
};

struct ScenePick {
  glm::dvec3 world{0};
  DesignId design;
  int element = -1;
  std::string stakePoint;
  FrameId frame;
};

/// The site in 3D: scan, design, stake points, camera frusta and trajectory. VTK inside, no Qt: the
/// widget owns the render window's context and forwards events in pixels. Not thread-safe; call with
/// the context current.
class SiteView {
 public:
  SiteView();
  ~SiteView();
  vtkGenericOpenGLRenderWindow* renderWindow() const;

  void setClouds(const std::vector<std::shared_ptr<const PointStore>>& clouds, double density, double pointSize);
  void setDesigns(const std::vector<SceneDesign>& designs);
  void setStakePoints(const std::vector<StakePoint>& points);
  void setFrames(const std::vector<SceneFrustum>& frames);
  void setCurrentFrame(FrameId frame);
  void setSelectedElement(DesignId design, int element);
  void setSelectedStakePoint(const std::string& name);

  void resize(int widthPx, int heightPx, double devicePixelRatio);
  void fitAll();
  void lookFromFrame(FrameId frame);
  /// Orbits about what was under the cursor at beginDrag. Positions in device pixels from the top left.
  void beginDrag(const glm::dvec2& px);
  void orbit(const glm::dvec2& deltaPx);
  void pan(const glm::dvec2& deltaPx);
  void zoomAt(const glm::dvec2& px, double factor);
  std::optional<ScenePick> pick(const glm::dvec2& px);
  void render();

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
