// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <span>
#include <vector>

#include "cloud/octree.h"
#include "cloud/point_store.h"

namespace alidade {

/// Fills CloudNode::spacing and returns the median over all points, metres.
///
/// A surface with rho points a square metre has k of them within r_k with E[pi rho r_k²] = k, so
/// sqrt(pi r_k² / k) estimates the side of the square that holds one point. It is taken from the
/// 8th neighbour among the node's own points at a dozen places of each node, and scaled to all
/// levels by the share of them that the node holds.
double measureSpacing(std::span<CloudNode> nodes, std::span<const OctreeNodeLevels> levels,
                      std::span<const DisplayPoint> points, const LevelLaw& law);

}  // namespace alidade
