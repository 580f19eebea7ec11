// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "camera/camera.h"
#include "cloud/frame_pacer.h"
#include "cloud/point_styler.h"
#include "geometry/bounds.h"
#include "geometry/rigid_transform.h"
#include "survey/design_model.h"
#include "survey/display_settings.h"
#include "survey/project.h"

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

/// What is under the cursor, nearest first. All ids empty: a point of the scan.
struct ScenePick {
  glm::dvec3 world{0};  ///< metres; a scan point's are its source's own
  DesignId design;
  int element = -1;     ///< index in the design; -1: not a design
  std::string stakePoint;
  FrameId frame;
};

/// What the view asks of the widget that owns the OpenGL context.
struct SceneContext {
  std::function<void()> makeCurrent;
  std::function<bool()> isCurrent;
};

/// The site in 3D: scan, design, stake points, camera frusta and trajectory. VTK inside, but for the scan's points, which the
/// point engine draws; no Qt, and no VTK header outside this folder. Everything is drawn in float relative to a local origin near
/// the data; positions in and out are world doubles. Not thread-safe.
///
/// The widget (a QOpenGLWidget; core profile 3.2, 24 bit depth, no samples) calls
/// - `attach` from initializeGL and again whenever it got a new context (docking),
/// - `release` with the old context still current before that context dies (aboutToBeDestroyed),
/// - `resize` from resizeGL, `paint(defaultFramebufferObject())` from paintGL.
/// Everything else may be called without a context; it shows at the next `paint`. Picking and the
/// camera are computed on the CPU and need none either.
class SiteView {
 public:
  SiteView();
  ~SiteView();
  SiteView(const SiteView&) = delete;
  SiteView& operator=(const SiteView&) = delete;

  void attach(const SceneContext& context);
  void release();
  /// Draws into this framebuffer object of the current context and leaves its alpha at 1.
  void paint(unsigned framebuffer);

  void setClouds(const std::vector<ScanPoints>& clouds);
  /// How the points are drawn: the same density, size and style as over the picture.
  void setDisplay(const DisplaySettings& display);
  /// How quick the view is while it moves; the still one shows all that the density asks for.
  void setPace(const FramePace& pace);
  void setDesigns(const std::vector<SceneDesign>& designs);
  void setStakePoints(const std::vector<StakePoint>& points);
  /// All posed frames; a few hundred frusta at most are drawn, the trajectory goes through all.
  void setFrames(const std::vector<SceneFrustum>& frames);
  void setCurrentFrame(FrameId frame);
  void setSelectedElement(DesignId design, int element);
  void setSelectedStakePoint(const std::string& name);

  /// Device pixels; the ratio scales lines, markers and labels.
  void resize(int widthPx, int heightPx, double devicePixelRatio);
  /// While true as many points are drawn as keep the pace, so that dragging stays fluid. Set it false
  /// when the mouse is released and paint again.
  void setMoving(bool moving);
  /// Shows what the work is about: design, stake-out points and cameras; the scan where there is no design.
  void fitAll();
  void fitTo(const Bounds& world);
  void lookFromFrame(FrameId frame);
  /// Orbits about what was under the cursor at beginDrag. Positions in device pixels from the top left.
  void beginDrag(const glm::dvec2& px);
  void orbit(const glm::dvec2& deltaPx);
  /// What was under the cursor at beginDrag stays under it.
  void pan(const glm::dvec2& deltaPx);
  /// factor > 1 comes nearer; what is under the cursor stays under it.
  void zoomAt(const glm::dvec2& px, double factor);
  std::optional<ScenePick> pick(const glm::dvec2& px) const;
  /// Device pixel of a world point and its depth in metres; nothing behind the eye.
  std::optional<glm::dvec3> project(const glm::dvec3& world) const;
  /// Points that a still picture of this view shows.
  std::uint64_t stillPointCount() const;
  /// Points of the last picture.
  std::uint64_t drawnPointCount() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
