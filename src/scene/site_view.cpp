// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/site_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <vtkCamera.h>
#include <vtkRenderer.h>

#include "scene/cloud_layer.h"
#include "scene/design_layer.h"
#include "scene/frame_layer.h"
#include "scene/gl_target.h"
#include "scene/stake_layer.h"
#include "scene/view_camera.h"

namespace alidade {

namespace {

// Neutral and dark: colours of scans and designs are judged against it.
constexpr double kBackground[3] = {0.155, 0.160, 0.170};
// Data farther from the local origin than this moves the origin: floats step by 0.06 mm at 1 km.
constexpr double kOriginReach = 1000.0;
constexpr double kPointRadiusPx = 4.0;
// The nearest plane as a part of the distance to what the user works at: a nearer one costs depth
// resolution (edges show through), a farther one cuts off what stands beside the eye.
constexpr double kNearPart = 0.01;
constexpr double kNearestPlane = 1e-5;  // of the farthest plane

}  // namespace

struct SiteView::Impl {
  GlTarget target;
  vtkSmartPointer<vtkRenderer> renderer = vtkSmartPointer<vtkRenderer>::New();
  CloudLayer clouds{renderer};
  SceneDesignLayer designs{renderer};
  FrameLayer frames{renderer};
  StakeLayer stakes{renderer};
  ViewCamera camera;

  glm::dvec3 origin{0};
  bool hasOrigin = false;
  bool touched = false;  ///< the user has moved the view: new data no longer does
  bool moving = false;
  double pointSize = 1, ratio = 1;
  FramePace pace;
  FramePacer pacer;
  glm::dvec3 pivot{0};  ///< what was under the cursor when the drag began

  Impl() {
    renderer->SetBackground(kBackground[0], kBackground[1], kBackground[2]);
    target.window()->AddRenderer(renderer);
    applyScale();
  }

  Bounds siteBounds() const {
    Bounds all = clouds.bounds();
    all.add(designs.bounds());
    all.add(stakes.bounds());
    return all;
  }

  Bounds allBounds() const {
    Bounds all = siteBounds();
    all.add(frames.bounds());
    return all;
  }

  /// What the work is about. A scan reaches far beyond it (a few returns from the next street shrink
  /// the site to a speck), so it counts only where there is no design.
  Bounds workBounds() const {
    Bounds work = designs.bounds();
    if (work.empty()) return allBounds();
    work.add(stakes.bounds());
    work.add(frames.bounds());
    return work;
  }

  void buildFrames() {
    const Bounds site = siteBounds();
    frames.build(origin, site.empty() ? frames.bounds().diagonal() : site.diagonal());
  }

  /// After new data: keeps the local origin among it, and shows the first data that comes.
  void settle(const Bounds& added) {
    const Bounds all = allBounds();
    if (all.empty()) return;
    const double reach = std::max(kOriginReach, 0.5 * all.diagonal());
    if (!hasOrigin || glm::length(all.centre() - origin) > reach) {
      origin = glm::round(all.centre());
      hasOrigin = true;
      designs.build(origin);
      stakes.build(origin);
    }
    buildFrames();
    if (!touched && !added.empty()) {
      const Bounds work = workBounds();
      camera.fit(work);
      pivot = work.centre();
    }
  }

  void applyScale() {
    clouds.setPixelRatio(ratio);
    designs.setLineScale(ratio);
    frames.setLineScale(ratio);
    stakes.setScale(ratio);
  }

  void applyCamera() {
    vtkCamera* vtk = renderer->GetActiveCamera();
    const glm::dvec3 eye = camera.position() - origin, focus = eye + camera.forward(), up = camera.up();
    vtk->SetPosition(eye.x, eye.y, eye.z);
    vtk->SetFocalPoint(focus.x, focus.y, focus.z);
    vtk->SetViewUp(up.x, up.y, up.z);
    vtk->SetViewAngle(glm::degrees(camera.verticalFov()));
    const Bounds all = allBounds();
    double nearest = std::numeric_limits<double>::infinity(), farthest = 1.0;
    // Frusta and markers stick out of the bounds of their centres.
    const double slack = 0.05 * all.diagonal() + 1.0;
    for (int corner = 0; corner < 8 && !all.empty(); ++corner) {
      const double depth = camera.depthOf(all.corner(corner));
      nearest = std::min(nearest, depth - slack);
      farthest = std::max(farthest, depth + slack);
    }
    const double work = camera.depthOf(pivot);
    const double least = std::max(kNearestPlane * farthest, work > 0 ? std::min(kNearPart * work, 0.1 * farthest) : 0.0);
    vtk->SetClippingRange(std::clamp(nearest, least, 0.9 * farthest), farthest);
  }

  std::optional<LayerHit> hit(const glm::dvec2& px) {
    std::optional<LayerHit> best = designs.hit(camera, px);
    const double radius = std::max(kPointRadiusPx * ratio, 0.75 * pointSize * ratio);
    if (auto point = clouds.hit(camera, px, radius); point && (!best || point->depth < best->depth)) best = point;
    // Marks are drawn as marks: they win over the surface that they stand on.
    const auto over = [&](const std::optional<LayerHit>& mark) {
      if (mark && (!best || mark->depth < best->depth * 1.01 + 0.05)) best = mark;
    };
    over(frames.hit(camera, px));
    over(stakes.hit(camera, px));
    return best;
  }

  /// What is under the cursor; else the point of its ray as deep as the last pivot.
  glm::dvec3 grasp(const glm::dvec2& px) {
    if (const auto found = hit(px)) return found->pick.world;
    const ViewRay ray = camera.rayThrough(px);
    double depth = camera.depthOf(pivot);
    const Bounds all = allBounds();
    if (!(depth > 0) && !all.empty()) depth = camera.depthOf(all.centre());
    if (!(depth > 0)) depth = 10.0;
    return ray.origin + ray.direction * (depth / glm::dot(ray.direction, camera.forward()));
  }
};

SiteView::SiteView() : m_impl(std::make_unique<Impl>()) {}
SiteView::~SiteView() = default;

void SiteView::attach(const SceneContext& context) {
  m_impl->target.attach(context);
}

void SiteView::release() {
  m_impl->target.release();
}

void SiteView::paint(unsigned framebuffer) {
  Impl& d = *m_impl;
  if (!d.target.attached()) return;
  const std::uint64_t budget = d.pacer.begin(d.moving ? std::optional(d.pace) : std::nullopt);
  d.applyCamera();
  d.clouds.draw(d.camera, budget);
  d.stakes.placeLabels(d.camera);
  d.target.paint(framebuffer, d.camera.width(), d.camera.height());
  d.pacer.end(d.clouds.drawnCount());
}

void SiteView::setClouds(const std::vector<ScanPoints>& clouds) {
  m_impl->clouds.set(clouds);
  m_impl->settle(m_impl->clouds.bounds());
}

void SiteView::setDisplay(const DisplaySettings& display) {
  m_impl->pointSize = display.pointSize;
  m_impl->clouds.setDisplay(display);
}

void SiteView::setPace(const FramePace& pace) {
  m_impl->pace = pace;
}

void SiteView::setDesigns(const std::vector<SceneDesign>& designs) {
  m_impl->designs.set(designs);
  m_impl->designs.build(m_impl->origin);
  m_impl->settle(m_impl->designs.bounds());
}

void SiteView::setStakePoints(const std::vector<StakePoint>& points) {
  m_impl->stakes.set(points);
  m_impl->stakes.build(m_impl->origin);
  m_impl->settle(m_impl->stakes.bounds());
}

void SiteView::setFrames(const std::vector<SceneFrustum>& frames) {
  m_impl->frames.set(frames);
  m_impl->settle(m_impl->frames.bounds());
}

void SiteView::setCurrentFrame(FrameId frame) {
  m_impl->frames.setCurrent(frame);
}

void SiteView::setSelectedElement(DesignId design, int element) {
  m_impl->designs.select(design, element);
}

void SiteView::setSelectedStakePoint(const std::string& name) {
  m_impl->stakes.select(name);
}

void SiteView::resize(int widthPx, int heightPx, double devicePixelRatio) {
  m_impl->camera.resize(widthPx, heightPx);
  m_impl->ratio = devicePixelRatio > 0 ? devicePixelRatio : 1.0;
  m_impl->target.window()->SetSize(m_impl->camera.width(), m_impl->camera.height());
  m_impl->target.window()->SetDPI(72);
  m_impl->applyScale();
}

void SiteView::setMoving(bool moving) {
  m_impl->moving = moving;
}

void SiteView::fitAll() {
  fitTo(m_impl->workBounds());
}

void SiteView::fitTo(const Bounds& world) {
  if (world.empty()) return;
  m_impl->touched = true;
  m_impl->camera.fit(world);
  m_impl->pivot = world.centre();
}

void SiteView::lookFromFrame(FrameId frame) {
  const SceneFrustum* found = m_impl->frames.find(frame);
  if (found == nullptr) return;
  const RigidTransform worldFromCamera = found->cameraFromWorld.inverse();
  const Intrinsics& k = found->camera.intrinsics();
  if (!(k.fx > 0) || !(k.fy > 0)) return;
  m_impl->touched = true;
  m_impl->camera.lookFrom(worldFromCamera.translation, worldFromCamera.rotation * glm::dvec3(0, 0, 1),
                          worldFromCamera.rotation * glm::dvec3(0, -1, 0), 2.0 * std::atan(0.5 * k.width / k.fx),
                          2.0 * std::atan(0.5 * k.height / k.fy));
  m_impl->pivot = m_impl->grasp(0.5 * glm::dvec2(m_impl->camera.width(), m_impl->camera.height()));
}

void SiteView::beginDrag(const glm::dvec2& px) {
  m_impl->touched = true;
  m_impl->pivot = m_impl->grasp(px);
}

void SiteView::orbit(const glm::dvec2& deltaPx) {
  m_impl->camera.orbit(m_impl->pivot, deltaPx / m_impl->ratio);
}

void SiteView::pan(const glm::dvec2& deltaPx) {
  m_impl->camera.pan(m_impl->pivot, deltaPx);
}

void SiteView::zoomAt(const glm::dvec2& px, double factor) {
  m_impl->touched = true;
  m_impl->pivot = m_impl->grasp(px);
  m_impl->camera.zoomTowards(m_impl->pivot, factor);
}

std::optional<ScenePick> SiteView::pick(const glm::dvec2& px) const {
  const auto found = m_impl->hit(px);
  if (!found) return std::nullopt;
  return found->pick;
}

std::optional<glm::dvec3> SiteView::project(const glm::dvec3& world) const {
  return m_impl->camera.project(world);
}

std::uint64_t SiteView::stillPointCount() const {
  return m_impl->clouds.countFor(m_impl->camera);
}

std::uint64_t SiteView::drawnPointCount() const {
  return m_impl->clouds.drawnCount();
}

}  // namespace alidade
