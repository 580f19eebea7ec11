// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/anchors.h"

#include <algorithm>

namespace alidade {

namespace {

constexpr int kNearPx = 3;

/// An edge belongs to the surface in front of it.
float nearestAround(const DepthImage& depth, const glm::ivec2& at) {
  float nearest = depth.at(at.x, at.y);
  for (int y = std::max(0, at.y - kNearPx); y <= std::min(depth.height() - 1, at.y + kNearPx); ++y)
    for (int x = std::max(0, at.x - kNearPx); x <= std::min(depth.width() - 1, at.x + kNearPx); ++x)
      if (!(nearest <= depth.at(x, y)) && depth.at(x, y) > 0) nearest = depth.at(x, y);
  return nearest;
}

}  // namespace

std::vector<Anchor> anchorsOf(const ScanView& view, const Camera& camera, const RigidTransform& cameraFromWorld, int half,
                              int cellPx) {
  const RigidTransform worldFromCamera = cameraFromWorld.inverse();
  std::vector<Anchor> anchors;
  for (Patch& patch : choosePatches(view.luma, view.covered, half, cellPx)) {
    const auto direction = camera.unproject(glm::dvec2(patch.at));
    const double depth = view.ofEdges ? nearestAround(view.depth, patch.at) : view.depth.at(patch.at.x, patch.at.y);
    if (!direction || !(depth > 0)) continue;
    const glm::dvec3 world = worldFromCamera * (*direction * depth);
    anchors.push_back({std::move(patch), world});
  }
  return anchors;
}

}  // namespace alidade
