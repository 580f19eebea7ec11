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

void CloudLayer::set(const std::vector<ScanPoints>& clouds) {
  m_clouds.clear();
  for (const ScanPoints& points : clouds) m_clouds.push_back({points, std::make_unique<PointStyler>(points)});
}

void CloudLayer::addPoints(double fromShare, double toShare, const PointStyle& style) {
  for (std::size_t cloud = 0; cloud < m_clouds.size(); ++cloud) {
    const PointStore& store = *m_clouds[cloud].points.store;
    const auto prefixes = [&](double share) {
      Selection selection;
      const double level = store.levelOfShare(share);
      for (std::uint32_t n = 0; n < store.nodes().size(); ++n)
        if (const std::uint32_t count = share > 0 ? store.countBelow(n, level) : 0; count > 0)
          selection.ranges.push_back({n, store.nodes()[n].first, count, 0.0});
      m_clouds[cloud].styler->apply(style, PointStyler::Part::ColourAndFilter, m_origin, selection);
      return selection;
    };
    // The longer prefixes first: what is styled for them serves the shorter ones and stays where it is.
    const Selection all = prefixes(toShare), before = prefixes(fromShare);
    auto skipped = before.ranges.begin();
    for (const SelectedRange& range : all.ranges) {
      while (skipped != before.ranges.end() && skipped->node < range.node) ++skipped;
      const std::uint32_t from = skipped != before.ranges.end() && skipped->node == range.node ? skipped->count : 0;
      if (range.count <= from) continue;
      const CloudNode& node = store.nodes()[range.node];
      const DisplayPoint* points = range.styled ? range.styled : store.points().data() + range.first;
      m_ranges.push_back({m_points.size(), cloud, range.node});
      const glm::dvec3 corner = node.origin - m_origin;
      for (const DisplayPoint* point = points + from; point != points + range.count; ++point) {
        m_points.emplace_back(corner + node.step * glm::dvec3(point->x, point->y, point->z));
        m_colours.push_back(colourOf(point->rgb565));
      }
    }
  }
}

/// The source's own position of a drawn point: of the first in its node at the same place.
glm::dvec3 CloudLayer::positionOf(std::size_t drawn) const {
  const auto range = std::prev(std::upper_bound(
      m_ranges.begin(), m_ranges.end(), drawn, [](std::size_t d, const Range& r) { return d < r.firstDrawn; }));
  const PointStore& store = *m_clouds[range->cloud].points.store;
  const CloudNode& node = store.nodes()[range->node];
  const auto points = store.points().subspan(node.first, node.count);
  const glm::dvec3 corner = node.origin - m_origin;
  const auto found = std::find_if(points.begin(), points.end(), [&](const DisplayPoint& p) {
    return glm::vec3(corner + node.step * glm::dvec3(p.x, p.y, p.z)) == m_points[drawn];
  });
  return store.sourcePosition(node.first + static_cast<std::uint64_t>(found - points.begin()));
}

void CloudLayer::build(const glm::dvec3& origin, double density, std::uint64_t budget, const PointStyle& style) {
  m_origin = origin;
  m_points.clear();
  m_colours.clear();
  m_ranges.clear();
  std::uint64_t total = 0;
  for (const auto& cloud : m_clouds) total += cloud.points.store->pointCount();
  const double most = total > budget && total > 0 ? static_cast<double>(budget) / static_cast<double>(total) : 1.0;
  const double share = std::clamp(density, 0.0, 1.0) * most;
  // A small cloud moves fluidly as it is.
  const double coarse = share * static_cast<double>(total) < 200000.0 ? share : share * kCoarsePart;
  m_points.reserve(static_cast<std::size_t>(1.05 * share * static_cast<double>(total)) + 1000);
  m_colours.reserve(m_points.capacity());
  addPoints(0.0, coarse, style);
  const std::size_t split = m_points.size();
  addPoints(coarse, share, style);
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
  for (const auto& cloud : m_clouds) all.add(cloud.points.store->bounds());
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
  LayerHit found;
  found.pick.world = positionOf(best->first);
  found.depth = camera.depthOf(found.pick.world);
  return found;
}

}  // namespace alidade
