// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

#include "cloud/blue_noise.h"
#include "cloud/chunk_plan.h"
#include "cloud/levels.h"
#include "cloud/node_slab.h"
#include "cloud/raw_bytes.h"

namespace alidade {

enum class LevelKind : std::uint8_t {
  BlueNoise,  ///< even spacing, whatever the scan's own density
  Random,     ///< Zhang (2020): a random draw with the law of LevelLaw
};

/// What decides how a scan becomes a tree.
struct TreeOptions {
  LevelKind kind = LevelKind::BlueNoise;
  LevelLaw law;                ///< Random
  double lawShift = 0;         ///< Random: level of the law = level of the tile + lawShift
  std::uint32_t seed = 1;      ///< Random, and what thins whole tiles
  std::uint32_t leafPoints = 20000;
};

/// A node while the tree is put together.
struct BuildNode {
  glm::ivec3 tile{0};
  glm::ivec3 corner{0};                 ///< of its cube, units in the tile
  std::int32_t depth = 0;               ///< edge = 65536 / 2^depth units; negative above the tiles
  std::int32_t firstBucket = 0;         ///< level of the first entry of its table
  std::uint32_t bucketCount = 0;
  std::uint64_t tableOffset = 0;        ///< into the tables that it came with
  std::uint64_t first = 0;              ///< point, in the order that it came with
  std::uint32_t count = 0;
  std::int32_t firstChild = -1;
  std::uint32_t childCount = 0;
  glm::i64vec3 low{0}, high{-1};        ///< units: of the points in it and below; low > high where none
  std::uint64_t pointsBelow = 0;        ///< with its own
  NodeSlab slab;                        ///< of its own points, units in the tile
  float spacingUnits = 0;               ///< side of a square of surface that holds one point; 0: unknown

  bool hasBounds() const { return low.x <= high.x; }
  void addBounds(const BuildNode& other);
};

/// A part of the tree: nodes[0] is its root where there is one, children follow their parents and stand side by
/// side. Points and tables count from the part's own beginning.
struct SubTree {
  std::vector<BuildNode> nodes;
  std::vector<std::uint32_t> order;   ///< indices of the points in the nodes' order
  std::vector<std::uint32_t> tables;  ///< cumulative counts a level step, node by node
};

/// Bounds, counts and spacing of all parents from their children, which follow them.
void sumUp(std::vector<BuildNode>& nodes);

/// The points of one cell, Morton order, columns parallel.
struct CellPoints {
  RawVector<std::uint64_t> code;  ///< Morton in the tile; the lowest `droppedBits` bits an axis need not be sorted
  RawVector<std::uint32_t> row;   ///< index of the point in the source order of its cell
  RawVector<std::uint16_t> x, y, z;
  std::vector<std::int16_t> level;  ///< steps, in the tile
  int droppedBits = 0;

  std::size_t size() const { return row.size(); }
  TilePoints places() const { return {code, x, y, z}; }
};

/// A sample that neighbours must keep their distance from.
struct BorderSample {
  std::uint16_t x, y, z;
  std::int16_t from;  ///< accepted at every pass q >= from
};

/// Sorts a cell's points into `points`. `packed` holds x | y << 16 | z << 32 of each point, in source order; `keys` is
/// overwritten, and keeps its memory for the next cell.
void sortCell(const PlanCell& cell, std::span<const std::uint64_t> packed, RawVector<std::uint64_t>& keys, CellPoints& points);

/// Gives every point of the cell its level. Returns those that the cell leaves to the tree above it (level
/// below the cell's depth, undecided), ascending; none for a whole tile.
std::vector<std::uint32_t> assignLevels(const PlanCell& cell, CellPoints& points, std::span<const Obstacle> obstacles,
                                        const TreeOptions& options, BlueNoise& noise);

/// The samples near the cell's faces, once the levels are known; `undecided` as assignLevels returned it.
std::vector<BorderSample> borderSamples(const PlanCell& cell, const CellPoints& points, std::span<const std::uint32_t> undecided);

/// The cell's tree of all points that are not `undecided`.
SubTree buildCellTree(const PlanCell& cell, const CellPoints& points, std::span<const std::uint32_t> undecided,
                      const TreeOptions& options);

/// What cells left to the tree of their tile.
struct TopPoints {
  CellPoints points;                     ///< row: any numbering
  std::vector<std::int8_t> cellDepth;    ///< of the cell that a point comes from
};

/// Levels of the top points: passes coarser than their cells.
void assignTopLevels(const glm::ivec3& tile, TopPoints& top, std::span<const Obstacle> obstacles, const TreeOptions& options,
                     BlueNoise& noise);

/// The tile's tree above its cells. A node whose firstChild is -1 - i with childCount 1 stands for cell i.
SubTree buildTopTree(const glm::ivec3& tile, std::span<const PlanCell> cells, const TopPoints& top);

/// Distance-based obstacles for `cell` from a neighbour's border samples.
void addObstacles(const PlanCell& neighbour, std::span<const BorderSample> samples, const PlanCell& cell, int coarsest,
                  std::vector<Obstacle>& out);

}  // namespace alidade
