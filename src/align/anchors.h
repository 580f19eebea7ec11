// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "align/patch_matching.h"
#include "align/scan_view.h"

namespace alidade {

/// A patch of the drawn scene with the place in the world that its centre shows.
struct Anchor {
  Patch patch;
  glm::dvec3 world{0};
};

/// The patches of a view that can be matched, of 2 half + 1 pixels, one a cell at most.
std::vector<Anchor> anchorsOf(const ScanView& view, const Camera& camera, const RigidTransform& cameraFromWorld, int half,
                              int cellPx);

}  // namespace alidade
