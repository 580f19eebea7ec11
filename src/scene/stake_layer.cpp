// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/stake_layer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <vtkProperty.h>
#include <vtkTextProperty.h>

namespace alidade {

namespace {

constexpr glm::dvec3 kStakeColour{0.20, 0.85, 0.95};
constexpr glm::dvec3 kSelectionColour{1.0, 0.62, 0.10};
constexpr double kMarkerPx = 9.0;
constexpr int kFontPx = 13;
constexpr std::size_t kMostLabels = 60;
constexpr std::size_t kMostCircles = 2000;
constexpr int kCircleParts = 32;

struct Box {
  glm::dvec2 low, high;
  bool overlaps(const Box& other) const {
    return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
  }
};

}  // namespace

StakeLayer::StakeLayer(vtkRenderer* renderer)
    : m_renderer(renderer),
      m_markers(makeActor(kStakeColour, false)),
      m_circles(makeActor(kStakeColour, false)),
      m_selection(makeActor(kSelectionColour, false)) {
  for (const LitActor& each : {m_markers, m_circles, m_selection}) m_renderer->AddActor(each.actor);
}

void StakeLayer::build(const glm::dvec3& origin) {
  m_origin = origin;
  std::vector<glm::vec3> places, circle;
  std::vector<std::array<std::uint32_t, 2>> parts;
  for (const StakePoint& point : m_points) {
    const glm::dvec3 local = point.position - origin;
    places.emplace_back(local);
    if (places.size() > kMostCircles || !(point.toleranceM > 0)) continue;
    const auto first = static_cast<std::uint32_t>(circle.size());
    for (int i = 0; i < kCircleParts; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCircleParts;
      circle.emplace_back(local + point.toleranceM * glm::dvec3(std::cos(angle), std::sin(angle), 0.0));
      parts.push_back({first + i, first + (i + 1) % kCircleParts});
    }
  }
  m_markers.mapper->SetInputData(verticesOf(places, {}));
  m_circles.mapper->SetInputData(linesOf(circle, parts));
  for (const auto& each : m_labels) each->SetVisibility(0);
  buildSelection();
}

void StakeLayer::select(const std::string& name) {
  m_selected = name;
  buildSelection();
}

void StakeLayer::buildSelection() {
  std::vector<glm::vec3> chosen;
  for (const StakePoint& point : m_points)
    if (!m_selected.empty() && point.name == m_selected) chosen.emplace_back(point.position - m_origin);
  m_selection.mapper->SetInputData(verticesOf(chosen, {}));
}

void StakeLayer::setScale(double devicePixelRatio) {
  m_scale = devicePixelRatio;
  const auto marker = static_cast<float>(kMarkerPx * m_scale);
  m_markers.actor->GetProperty()->SetPointSize(marker);
  m_markers.actor->GetProperty()->SetRenderPointsAsSpheres(true);
  m_selection.actor->GetProperty()->SetPointSize(1.7f * marker);
  m_selection.actor->GetProperty()->SetRenderPointsAsSpheres(true);
  m_circles.actor->GetProperty()->SetLineWidth(static_cast<float>(1.5 * m_scale));
  for (const auto& each : m_labels) each->GetTextProperty()->SetFontSize(static_cast<int>(kFontPx * m_scale));
}

vtkBillboardTextActor3D* StakeLayer::label(std::size_t index) {
  while (m_labels.size() <= index) {
    auto made = vtkSmartPointer<vtkBillboardTextActor3D>::New();
    vtkTextProperty* style = made->GetTextProperty();
    style->SetFontFamilyToArial();
    style->SetFontSize(static_cast<int>(kFontPx * m_scale));
    style->SetColor(1, 1, 1);
    style->SetBackgroundColor(0.08, 0.09, 0.10);
    style->SetBackgroundOpacity(0.65);
    made->SetPickable(0);
    m_renderer->AddActor(made);
    m_labels.push_back(made);
  }
  return m_labels[index];
}

void StakeLayer::placeLabels(const ViewCamera& camera) {
  std::vector<std::pair<double, std::size_t>> inView;  // nearest first, the selected one before all
  for (std::size_t i = 0; i < m_points.size(); ++i) {
    const auto px = camera.project(m_points[i].position);
    if (!px || px->x < 0 || px->y < 0 || px->x > camera.width() || px->y > camera.height()) continue;
    inView.push_back({m_points[i].name == m_selected ? 0.0 : px->z, i});
  }
  std::sort(inView.begin(), inView.end());
  std::vector<Box> taken;
  for (const auto& [depth, i] : inView) {
    if (taken.size() == kMostLabels) break;
    const glm::dvec2 px(*camera.project(m_points[i].position));
    const glm::dvec2 size = m_scale * glm::dvec2(0.62 * kFontPx * (m_points[i].name.size() + 1.0), 1.5 * kFontPx);
    const Box box{px, px + size};
    if (std::any_of(taken.begin(), taken.end(), [&](const Box& other) { return other.overlaps(box); })) continue;
    vtkBillboardTextActor3D* text = label(taken.size());
    text->SetInput(m_points[i].name.c_str());
    const glm::dvec3 local = m_points[i].position - m_origin;
    text->SetPosition(local.x, local.y, local.z);
    const int aside = static_cast<int>(0.8 * kMarkerPx * m_scale);
    text->SetDisplayOffset(aside, aside / 2);
    text->SetVisibility(1);
    taken.push_back(box);
  }
  for (std::size_t i = taken.size(); i < m_labels.size(); ++i) m_labels[i]->SetVisibility(0);
}

Bounds StakeLayer::bounds() const {
  Bounds all;
  for (const StakePoint& point : m_points) all.add(point.position);
  return all;
}

std::optional<LayerHit> StakeLayer::hit(const ViewCamera& camera, const glm::dvec2& px) const {
  std::optional<LayerHit> best;
  const double reach = (0.5 * kMarkerPx + 3.0) * m_scale;
  for (const StakePoint& point : m_points) {
    const auto place = camera.project(point.position);
    if (!place || glm::length(glm::dvec2(*place) - px) > reach || (best && best->depth <= place->z)) continue;
    best = LayerHit{place->z, {}};
    best->pick.world = point.position;
    best->pick.stakePoint = point.name;
  }
  return best;
}

}  // namespace alidade
