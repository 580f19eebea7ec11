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
  double spacing = 0;  ///< metres between neighbours on the surface as drawn (levels above left out)
  /// What to draw instead of the store's own points: `count` copies, recoloured or filtered (see
  /// cloud/point_styler.h, which owns them); null for the store's own.
  const DisplayPoint* styled = nullptr;
};

struct Selection {
  std::vector<SelectedRange> ranges;  ///< front to back by node
  std::uint64_t pointCount = 0;
};

struct SelectionOptions {
  double density = 1.0;  ///< the slider, 0..1
  DensityLaw law = DensityLaw::PointsPerPixel;
  double pointsPerSquareMetre = 150000.0;
  double targetSpacingPx = 0.75;  ///< wanted distance between neighbours on screen at density 1
  std::uint64_t pointBudget = 0;  ///< 0: none
};

/// Which prefixes to draw for a camera: nodes inside the field of view of the real (distorted) lens,
/// each cut where its level reaches the wanted density. A point drawn at one density is drawn at
/// every higher one, and the count changes continuously.
///
/// With s the surface spacing at a node and d the distance from the eye to its nearest point, the
/// share of the levels that gives the wanted density is
///
///     points per pixel          F = (s f / (d targetSpacingPx))²
///     points per square metre   F = s² D / ln(d + 1)                  (Zhang 2020)
///
/// and the node is drawn up to the level that holds density · min(1, F) of the points. The count is
/// therefore proportional to the slider. A budget lowers the slider for all nodes alike.
Selection select(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                 const SelectionOptions& options);

/// Every point of every node in the field of view.
Selection selectAll(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld);

}  // namespace alidade
