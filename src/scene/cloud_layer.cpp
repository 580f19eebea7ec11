// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "scene/cloud_layer.h"

#include <algorithm>
#include <limits>

#include <vtkProperty.h>

namespace alidade {

namespace {

/// The part of the drawn points that is also drawn while the view moves.
constexpr double kCoarsePart = 0.12;

glm::u8vec3 colourOf(std::uint16_t rgb565) {
  const unsigned r = rgb565 >> 11, g = (rgb565 >> 5) & 63, b = rgb565 & 31;
  return {static_cast<std::uint8_t>((r * 527 + 23) >> 6), static_cast<std::uint8_t>((g * 259 + 33) >> 6),
          static_cast<std::uint8_t>((b * 527 + 23) >> 6)};
}

}  // namespace

CloudLayer::CloudLayer(vtkRenderer* renderer) : m_coarse(makeActor({1, 1, 1}, false)), m_fine(makeActor({1, 1, 1}, false)) {
  renderer->AddActor(m_coarse.actor);
  renderer->AddActor(m_fine.actor);
}

void CloudLayer::addPoints(double fromShare, double toShare) {
  for (std::size_t cloud = 0; cloud < m_clouds.size(); ++cloud) {
    const PointStore& store = *m_clouds[cloud];
    const double fromLevel = store.levelOfShare(fromShare), toLevel = store.levelOfShare(toShare);
    for (std::uint32_t n = 0; n < store.nodes().size(); ++n) {
      const CloudNode& node = store.nodes()[n];
      const std::uint32_t from = fromShare > 0 ? store.countBelow(n, fromLevel) : 0, to = store.countBelow(n, toLevel);
      if (to <= from) continue;
      m_ranges.push_back({m_points.size(), cloud, node.first + from});
      const glm::dvec3 corner = node.origin - m_origin;
      for (const DisplayPoint& point : store.points().subspan(node.first + from, to - from)) {
        m_points.emplace_back(corner + node.step * glm::dvec3(point.x, point.y, point.z));
        m_colours.push_back(colourOf(point.rgb565));
      }
    }
  }
}

void CloudLayer::build(const glm::dvec3& origin, double density, std::uint64_t budget) {
  m_origin = origin;
  m_points.clear();
  m_colours.clear();
  m_ranges.clear();
  std::uint64_t total = 0;
  for (const auto& cloud : m_clouds) total += cloud->pointCount();
  const double most = total > budget && total > 0 ? static_cast<double>(budget) / static_cast<double>(total) : 1.0;
  const double share = std::clamp(density, 0.0, 1.0) * most;
  // A small cloud moves fluidly as it is.
  const double coarse = share * static_cast<double>(total) < 200000.0 ? share : share * kCoarsePart;
  m_points.reserve(static_cast<std::size_t>(1.05 * share * static_cast<double>(total)) + 1000);
  m_colours.reserve(m_points.capacity());
  addPoints(0.0, coarse);
  const std::size_t split = m_points.size();
  addPoints(coarse, share);
  const std::span<const glm::vec3> points(m_points);
  const std::span<const glm::u8vec3> colours(m_colours);
  m_coarse.mapper->SetInputData(verticesOf(points.first(split), colours.first(split)));
  m_fine.mapper->SetInputData(verticesOf(points.subspan(split), colours.subspan(split)));
}

void CloudLayer::setPointSize(double pixels) {
  for (const LitActor& each : {m_coarse, m_fine})
    each.actor->GetProperty()->SetPointSize(static_cast<float>(std::clamp(pixels, 1.0, 32.0)));
}

void CloudLayer::setMoving(bool moving) {
  m_fine.actor->SetVisibility(!moving);
}

Bounds CloudLayer::bounds() const {
  Bounds all;
  for (const auto& cloud : m_clouds) all.add(cloud->bounds());
  return all;
}

std::optional<LayerHit> CloudLayer::hit(const ViewCamera& camera, const glm::dvec2& px, double radiusPx) const {
  // A cone about the cursor's ray, in floats relative to the eye: a million points take milliseconds.
  const ViewRay ray = camera.rayThrough(px);
  const glm::vec3 eye(ray.origin - m_origin), direction(ray.direction);
  const auto cosine = static_cast<float>(glm::dot(ray.direction, camera.forward()));
  const auto slope = static_cast<float>(radiusPx * camera.metresPerPixel(1.0)) * cosine;
  float nearest = std::numeric_limits<float>::max();
  std::vector<std::pair<std::size_t, glm::vec2>> candidates;  // index; distance along the ray, off it
  for (std::size_t i = 0; i < m_points.size(); ++i) {
    const glm::vec3 p = m_points[i] - eye;
    const float along = glm::dot(p, direction);
    const float limit = slope * along;
    if (along <= 0 || along > 1.02f * nearest) continue;
    const glm::vec3 off = glm::cross(p, direction);
    const float off2 = glm::dot(off, off);
    if (off2 > limit * limit) continue;
    nearest = std::min(nearest, along);
    candidates.push_back({i, {along, off2 / (along * along)}});
  }
  const std::pair<std::size_t, glm::vec2>* best = nullptr;
  for (const auto& candidate : candidates)
    if (candidate.second.x <= 1.02f * nearest && (best == nullptr || candidate.second.y < best->second.y))
      best = &candidate;
  if (best == nullptr) return std::nullopt;
  auto range = std::upper_bound(m_ranges.begin(), m_ranges.end(), best->first,
                                [](std::size_t drawn, const Range& r) { return drawn < r.firstDrawn; });
  --range;
  LayerHit found;
  found.pick.world = m_clouds[range->cloud]->sourcePosition(range->firstPoint + (best->first - range->firstDrawn));
  found.depth = camera.depthOf(found.pick.world);
  return found;
}

}  // namespace alidade
