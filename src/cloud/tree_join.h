// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "cloud/cell_tree.h"

namespace alidade {

/// One tile's trees: that of its top where it is cut, and one a cell, in the cells' order. A top node whose
/// firstChild is -1 - i with childCount 1 stands for the root of cell i.
struct TileTree {
  glm::ivec3 tile{0};
  std::vector<BuildNode> top;
  std::vector<std::vector<BuildNode>> cells;
};

/// All tiles (in Morton order) under one root: breadth first, children side by side after their parents.
/// The nodes that are added above the tiles hold no points and have negative depths.
std::vector<BuildNode> joinTrees(const std::vector<TileTree>& tiles);

}  // namespace alidade
