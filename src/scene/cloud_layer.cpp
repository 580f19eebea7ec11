// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/cloud_layer.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace alidade {

namespace {

PointView viewOf(const ViewCamera& camera, std::uint64_t budget) {
  return {camera.pinhole(), camera.cameraFromWorld(), budget, 0};
}

/// What of the settings the points are drawn by.
auto pointsOf(const DisplaySettings& d) {
  return std::tie(d.density, d.densityLaw, d.pointsPerSquareMetre, d.levelThreshold, d.pointSize, d.roundPoints, d.points);
}

/// A cone about the cursor's ray.
struct Cone {
  glm::dvec3 eye, direction;
  double slope = 0;  ///< its radius a metre along the ray

  bool mayMeet(const Bounds& box) const {
    if (box.empty()) return false;
    const glm::dvec3 to = box.centre() - eye;
    const double along = glm::dot(to, direction), reach = 0.5 * box.diagonal();
    return along > -reach && glm::length(to - along * direction) <= reach + slope * (along + reach);
  }
};

/// A displayed point in the cone.
struct Candidate {
  std::size_t layer;
  const SelectedRange* range;
  std::uint32_t place;  ///< among the range's displayed ones
  float along, off2;
};

}  // namespace

CloudLayer::CloudLayer(vtkRenderer* renderer) : m_picture(vtkSmartPointer<PictureProp>::New()) {
  renderer->AddViewProp(m_picture);
}

void CloudLayer::set(const std::vector<ScanPoints>& clouds) {
  m_clouds = clouds;
  m_chosenFor.reset();
}

void CloudLayer::setDisplay(const DisplaySettings& display) {
  if (pointsOf(display) == pointsOf(m_display)) return;
  m_display = display;
  m_chosenFor.reset();
}

void CloudLayer::setPixelRatio(double ratio) {
  if (ratio == m_ratio) return;
  m_ratio = ratio;
  m_drawnFor.reset();
}

void CloudLayer::choose(const View& view) {
  if (m_chosenFor == view) return;
  m_points = m_painter.choose(m_clouds, m_display, viewOf(view.camera, view.budget));
  m_chosenFor = view;
  m_drawnFor.reset();
}

void CloudLayer::draw(const ViewCamera& camera, std::uint64_t budget) {
  const View view{camera, budget};
  choose(view);
  if (m_drawnFor == view) return;
  if (m_points.drawn == 0) {
    m_picture->set({}, {});
  } else {
    DisplaySettings display = m_display;
    if (display.points.sizeLaw == PointSizeLaw::Fixed) display.pointSize *= m_ratio;
    SplatImages images = m_painter.draw(m_points, display, viewOf(camera, budget));
    m_picture->set(std::move(images.depth), std::move(images.colour));
  }
  m_drawnFor = view;
}

Bounds CloudLayer::bounds() const {
  Bounds all;
  for (const ScanPoints& cloud : m_clouds) all.add(cloud.store->bounds());
  return all;
}

std::uint64_t CloudLayer::countFor(const ViewCamera& camera) {
  choose({camera, 0});
  return m_points.drawn;
}

std::optional<LayerHit> CloudLayer::hit(const ViewCamera& camera, const glm::dvec2& px, double radiusPx) {
  // What is shown, be it of a moving view; else what would be.
  if (!m_chosenFor || !(m_chosenFor->camera == camera)) choose({camera, 0});
  const ViewRay ray = camera.rayThrough(px);
  const double cosine = glm::dot(ray.direction, camera.forward());
  const Cone cone{ray.origin, ray.direction, radiusPx * camera.metresPerPixel(1.0) * cosine};
  const glm::vec3 direction(cone.direction);
  const auto slope = static_cast<float>(cone.slope);
  float nearest = std::numeric_limits<float>::max();
  std::vector<Candidate> candidates;
  for (std::size_t layer = 0; layer < m_points.layers.size(); ++layer) {
    const PointStore& store = *m_points.layers[layer].store;
    for (const SelectedRange& range : m_points.layers[layer].selection.ranges) {
      const CloudNode& node = store.nodes()[range.node];
      if (!cone.mayMeet(node.bounds)) continue;
      const DisplayPoint* points = range.styled ? range.styled : store.points().data() + range.first;
      const glm::vec3 corner(node.origin - cone.eye);
      const auto step = static_cast<float>(node.step);
      for (std::uint32_t i = 0; i < range.count; ++i) {
        const glm::vec3 p = corner + step * glm::vec3(points[i].x, points[i].y, points[i].z);
        const float along = glm::dot(p, direction);
        if (along <= 0 || along > 1.02f * nearest) continue;
        const glm::vec3 off = glm::cross(p, direction);
        const float off2 = glm::dot(off, off), limit = slope * along;
        if (off2 > limit * limit) continue;
        nearest = std::min(nearest, along);
        candidates.push_back({layer, &range, i, along, off2 / (along * along)});
      }
    }
  }
  const Candidate* best = nullptr;
  for (const Candidate& candidate : candidates)
    if (candidate.along <= 1.02f * nearest && (best == nullptr || candidate.off2 < best->off2)) best = &candidate;
  if (best == nullptr) return std::nullopt;
  const std::uint32_t place = best->range->places ? best->range->places[best->place] : best->place;
  LayerHit found;
  found.pick.world = m_points.layers[best->layer].store->sourcePosition(best->range->first + place);
  found.depth = camera.depthOf(found.pick.world);
  return found;
}

}  // namespace alidade
