// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera.h"
#include "cloud/point_store.h"
#include "geometry/rigid_transform.h"
#include "survey/display_settings.h"

namespace alidade {

/// Points [first, first + count) of a store: a prefix of one node.
struct SelectedRange {
  std::uint32_t node = 0;
  std::uint64_t first = 0;
  std::uint32_t count = 0;
};

struct Selection {
  std::vector<SelectedRange> ranges;  ///< front to back by node
  std::uint64_t pointCount = 0;
};

struct SelectionOptions {
  double density = 1.0;  ///< the slider, 0..1
  DensityLaw law = DensityLaw::PointsPerPixel;
  double pointsPerSquareMetre = 150000.0;
  double targetSpacingPx = 0.75;     ///< wanted distance between neighbours on screen at density 1
  std::uint64_t pointBudget = 0;     ///< 0: none
};

/// Which prefixes to draw for a camera: nodes inside the field of view of the real (distorted) lens,
/// each cut where its level reaches the wanted density. A point drawn at one density is drawn at
/// every higher one, and the count changes continuously.
Selection select(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                 const SelectionOptions& options);

}  // namespace alidade
