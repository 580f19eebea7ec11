// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <span>
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
  /// Where in the range each of `styled` stood, ascending; null: they are its first.
  const std::uint32_t* places = nullptr;
};

struct Selection {
  std::vector<SelectedRange> ranges;  ///< front to back by node
  std::uint64_t pointCount = 0;
  double loweredSteps = 0;  ///< that the slider and the budget lowered all levels by
  std::shared_ptr<const void> owner;  ///< of what cutByPoint() lets ranges draw
};

struct SelectionOptions {
  double density = 1.0;  ///< the slider, 0..1
  DensityLaw law = DensityLaw::PointsPerPixel;
  LevelThreshold threshold = LevelThreshold::ByDistance;
  double pointsPerSquareMetre = 150000.0;
  double targetSpacingPx = 1.0;  ///< wanted distance between neighbours on screen at density 1: a point a pixel
  /// Points per pixel by distance: fewer of them where a surface is seen at an angle, and so as many on screen. The laws and
  /// thresholds of Zhang (2020) know the distance alone.
  bool byFacing = true;
  std::uint64_t pointBudget = 0;  ///< over all stores; 0: none
};

/// Which prefixes to draw for a camera: nodes inside the field of view of the real (distorted) lens,
/// each cut where its level reaches the wanted density. A point drawn at one density is drawn at
/// every higher one, and the count changes continuously.
///
/// At density 1 a node is drawn down to the level l1 whose spacing is, at the distance d from the eye to the
/// node's nearest point,
///
///     points per pixel          w = targetSpacingPx d / (f sqrt(c))
///     points per square metre   w = sqrt(ln(d + 1) / D)                  (Zhang 2020)
///
/// where c is the share of its area that the node's surface shows to the eye (facingOf(), in cloud/node_slab.h), 1 where byFacing does not
/// hold.
///
/// For blue noise l1 follows from w alone; for random levels it is the level below which the share
/// (spacing / w)² of the node's surroundings lies. The slider and the budget lower all of a view's levels by
/// the same delta octaves, over all stores: the spacing on screen grows evenly, and delta is chosen so that
/// the count is the slider's share of the count at density 1.
std::vector<Selection> select(std::span<const std::shared_ptr<const PointStore>> stores, const Camera& camera,
                              const RigidTransform& cameraFromWorld, const SelectionOptions& options);
Selection select(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                 const SelectionOptions& options);

/// What LevelThreshold::ByPoint leaves of the prefixes that ByDistance chose without byFacing, with options otherwise the same: ranges draw
/// copies of the points that their own distance wants. A PointStyler's ranges stay as they are coloured and filtered,
/// and may change again after this. Costs a pass over the points in view. select() with ByPoint does both.
void cutByPoint(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld,
                const SelectionOptions& options, Selection& selection);

/// Every point of every node in the field of view.
Selection selectAll(const PointStore& store, const Camera& camera, const RigidTransform& cameraFromWorld);

}  // namespace alidade
