// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "cloud/point_store.h"

namespace alidade {

/// What the octree sorts: a point's place (21 bits an axis, Morton order), its continuous level and
/// its index in the source.
struct OctreeItem {
  std::uint64_t key;
  float level;
  std::uint32_t index;
};

/// The cube that the keys count in: 2^21 cells a side, edge and corner multiples of a power of two,
/// so that cells, steps and corners are exact in double wherever the survey's coordinates are.
struct OctreeFrame {
  glm::dvec3 corner{0};
  double size = 1;

  static constexpr int kBits = 21;
  static OctreeFrame around(const Bounds& bounds);

  std::uint64_t keyOf(const glm::dvec3& position) const;
  double sizeAt(std::uint32_t depth) const;
  glm::dvec3 cornerOf(std::uint64_t key, std::uint32_t depth) const;
};

struct OctreeOptions {
  std::uint32_t leafPoints = 20000;
  int deepestLevel = 1;
  double finestStepMeters = 1e-3;  ///< a node's 16-bit step stays at or below it
};

/// A node's share of levels, beside the node: [levelFrom, levelTo).
struct OctreeNodeLevels {
  double from = 0;
  double to = 0;
};

struct Octree {
  std::vector<CloudNode> nodes;          ///< origin, step, size, depth, children, first, count
  std::vector<OctreeNodeLevels> levels;  ///< parallel to nodes
};

/// Orders `items` so that every node's points are one run, ascending in level, and describes the
/// nodes. Works in place and on all cores, breadth first. Nothing useful is left when cancelled.
Octree buildOctree(std::vector<OctreeItem>& items, const OctreeFrame& frame, const OctreeOptions& options,
                   const Progress& progress);

}  // namespace alidade
