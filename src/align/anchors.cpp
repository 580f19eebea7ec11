// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/anchors.h"

namespace alidade {

std::vector<Anchor> anchorsOf(const ScanView& view, const Camera& camera, const RigidTransform& cameraFromWorld, int half,
                              int cellPx) {
  const RigidTransform worldFromCamera = cameraFromWorld.inverse();
  std::vector<Anchor> anchors;
  for (Patch& patch : choosePatches(view.luma, view.covered, half, cellPx)) {
    const auto direction = camera.unproject(glm::dvec2(patch.at));
    const double depth = view.depth.at(patch.at.x, patch.at.y);
    if (!direction || !(depth > 0)) continue;
    const glm::dvec3 world = worldFromCamera * (*direction * depth);
    anchors.push_back({std::move(patch), world});
  }
  return anchors;
}

}  // namespace alidade
