// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/selection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace alidade {

namespace {

/// The lens's field of view as a pyramid on the undistorted image plane: wide enough for every
/// pixel of the distorted picture.
class FieldOfView {
 public:
  FieldOfView(const Camera& camera, const RigidTransform& cameraFromWorld)
      : m_rotation(cameraFromWorld.rotationMatrix()), m_translation(cameraFromWorld.translation) {
    glm::dvec2 low(0.0), high(0.0);
    bool whole = true;
    const auto look = [&](double u, double v) {
      const auto direction = camera.unproject({u, v});
      whole = whole && direction.has_value();
      if (!direction) return;
      low = glm::min(low, glm::dvec2(*direction));
      high = glm::max(high, glm::dvec2(*direction));
    };
    // The lens maps the picture's border onto the border of what it sees, so the border is enough.
    constexpr int kSteps = 64;
    for (int i = 0; i <= kSteps; ++i) {
      const double u = -0.5 + camera.width() * (i / static_cast<double>(kSteps));
      const double v = -0.5 + camera.height() * (i / static_cast<double>(kSteps));
      for (const double edge : {-0.5, camera.height() - 0.5}) look(u, edge);
      for (const double edge : {-0.5, camera.width() - 0.5}) look(edge, v);
    }
    const double reach = camera.imageRadius();
    if (!whole) low = glm::dvec2(-reach), high = glm::dvec2(reach);
    // Between two samples the border may bulge by a little.
    const glm::dvec2 margin = 0.01 * (high - low) + 1e-3;
    low = glm::max(low - margin, glm::dvec2(-reach));
    high = glm::min(high + margin, glm::dvec2(reach));
    m_planes = {glm::dvec3(0, 0, 1), glm::dvec3(1, 0, -low.x), glm::dvec3(-1, 0, high.x),
                glm::dvec3(0, 1, -low.y), glm::dvec3(0, -1, high.y)};
    m_unbounded = !std::isfinite(reach) && !whole;
  }

  /// False only where no point of the box can fall into the picture.
  bool maySee(const Bounds& bounds) const {
    const glm::dvec3 centre = m_rotation * bounds.centre() + m_translation;
    const glm::dvec3 half = 0.5 * bounds.size();
    const std::size_t planes = m_unbounded ? 1 : m_planes.size();
    for (std::size_t i = 0; i < planes; ++i) {
      const glm::dvec3 inWorld = glm::transpose(m_rotation) * m_planes[i];
      if (glm::dot(m_planes[i], centre) + glm::dot(glm::abs(inWorld), half) < 0.0) return false;
    }
    return true;
  }

 private:
  glm::dmat3 m_rotation;
  glm::dvec3 m_translation;
  std::array<glm::dvec3, 5> m_planes;  ///< inward normals in the camera frame, all through the eye
  bool m_unbounded = false;
};

struct Candidate {
  std::uint32_t node = 0;
  double distance = 0;  ///< from the eye to the nearest point of the bounds, metres
  double share = 0;     ///< of the levels at density 1
};

/// Nodes in the field of view that hold points, front to back.
std::vector<Candidate> visibleNodes(const PointStore& store, const Camera& camera,
                                    const RigidTransform& cameraFromWorld) {
  std::vector<Candidate> found;
  const auto nodes = store.nodes();
  if (nodes.empty() || camera.width() <= 0 || !cameraFromWorld.isFinite()) return found;
  const FieldOfView view(camera, cameraFromWorld);
  const glm::dvec3 eye = cameraFromWorld.centre();
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t index = stack.back();
    stack.pop_back();
    const CloudNode& node = nodes[index];
    if (!view.maySee(node.bounds)) continue;
    if (node.count > 0) {
      const glm::dvec3 nearest = glm::clamp(eye, node.bounds.min, node.bounds.max);
      found.push_back({index, glm::length(nearest - eye), 1.0});
    }
    for (std::uint32_t c = 0; c < node.childCount; ++c) {
      stack.push_back(static_cast<std::uint32_t>(node.firstChild) + c);
    }
  }
  std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.node < b.node;
  });
  return found;
}

/// The share of the levels that gives the wanted density at the node's distance, in [0,1].
double wantedShare(const CloudNode& node, double distance, double focal, const SelectionOptions& options) {
  // Coinciding points tell no spacing; they are drawn rather than lost.
  if (node.spacing <= 0.0 || distance <= 0.0) return 1.0;
  double share = 1.0;
  if (options.law == DensityLaw::PointsPerPixel) {
    const double onScreen = node.spacing * focal / (distance * options.targetSpacingPx);
    share = onScreen * onScreen;
  } else {
    share = node.spacing * node.spacing * options.pointsPerSquareMetre / std::log1p(distance);
  }
  return share >= 0.0 ? std::min(share, 1.0) : 1.0;
}

/// How many of the node's points lie below the level that holds `share` of all.
std::uint32_t prefixOf(const PointStore& store, const CloudNode& node, double share) {
  if (share <= 0.0) return 0;
  if (share >= 1.0) return node.count;
  const auto levels = store.levels().subspan(node.first, node.count);
  const double level = store.levelLaw().levelOfShare(share);
  return static_cast<std::uint32_t>(std::lower_bound(levels.begin(), levels.end(), level) - levels.begin());
}

Selection selectionAt(const PointStore& store, const std::vector<Candidate>& candidates, double density) {
  Selection selection;
  for (const Candidate& candidate : candidates) {
    const CloudNode& node = store.nodes()[candidate.node];
    const double share = density * candidate.share;
    const std::uint32_t count = prefixOf(store, node, share);
    if (count == 0) continue;
    selection.ranges.push_back({candidate.node, node.first, count, node.spacing / std::sqrt(share)});
    selection.pointCount += count;
  }
  return selection;
}

std::uint64_t countAt(const PointStore& store, const std::vector<Candidate>& candidates, double density) {
  std::uint64_t count = 0;
  for (const Candidate& candidate : candidates) {
    count += prefixOf(store, store.nodes()[candidate.node], density * candidate.share);
  }
  return count;
}

/// The largest density up to `density` that stays within the budget. The count grows with the
/// density, so bisection finds it, and a slider beyond it changes nothing.
double densityWithin(const PointStore& store, const std::vector<Candidate>& candidates, double density,
                     std::uint64_t budget) {
  if (budget == 0 || countAt(store, candidates, density) <= budget) return density;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (countAt(store, candidates, middle) <= budget ? low : high) = middle;
  }
  return std::min(low, density);
}

}  // namespace

Selection select(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                 const SelectionOptions& options) {
  const double density = std::clamp(options.density, 0.0, 1.0);
  if (!(density > 0.0)) return {};
  std::vector<Candidate> candidates = visibleNodes(store, camera, cameraFromWorld);
  const double focal = std::sqrt(std::abs(camera.intrinsics().fx * camera.intrinsics().fy));
  for (Candidate& candidate : candidates) {
    candidate.share = wantedShare(store.nodes()[candidate.node], candidate.distance, focal, options);
  }
  return selectionAt(store, candidates, densityWithin(store, candidates, density, options.pointBudget));
}

Selection selectAll(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld) {
  return selectionAt(store, visibleNodes(store, camera, cameraFromWorld), 1.0);
}

}  // namespace alidade
