// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/cell_tree.h"
#include "cloud/lattice.h"
#include "cloud/levels.h"
#include "cloud/node_slab.h"
#include "cloud/point_schema.h"
#include "geometry/bounds.h"
#include "survey/point_batch.h"

namespace alidade {

/// What is read per point while drawing: 16-bit position in its node's cube and RGB565.
struct DisplayPoint {
  std::uint16_t x, y, z;
  std::uint16_t rgb565;
};
static_assert(sizeof(DisplayPoint) == 8);

/// A cube of the octree with the points whose level falls to it, sorted by level: any prefix of
/// [first, first+count) is a coarser picture of the node.
///
/// The tree is cut into tiles of 65536 lattice units. A tile's root holds all samples of the coarse levels in
/// it, a node below it the samples of one octave that no ancestor holds, a leaf all that is left. Nodes above
/// the tiles hold none and are there for culling.
struct CloudNode {
  /// World metres: position = origin + xyz * step. Exactly the source's position where the store's lattice is
  /// the source's own, within step/2 of it in each axis otherwise.
  glm::dvec3 origin{0};
  double step = 0;               ///< metres a 16-bit unit
  double size = 0;               ///< edge of the cube, metres
  Bounds bounds;                 ///< of the points in the node and in all below it, world
  std::uint32_t depth = 0;       ///< size = root size / 2^depth
  std::int32_t firstChild = -1;  ///< children are contiguous: [firstChild, firstChild + childCount)
  std::uint32_t childCount = 0;
  std::uint64_t first = 0;  ///< into points()
  std::uint32_t count = 0;
  /// Metres between neighbours here when every level is drawn: the side of a square of surface that
  /// holds one point.
  double spacing = 0;
  NodeSlab slab;  ///< of the node's own points: metres from origin
};

/// How a node's points spread over the levels: entry i of `cumulative` counts those below level step
/// firstStep + i + 1 (64 steps an octave).
struct NodeLevels {
  std::int32_t firstStep = 0;
  std::span<const std::uint32_t> cumulative;
};

/// A column beside the points, in the order of points(), mapped: read where it is looked at.
struct AttributeColumn {
  std::string name;
  NumberType type = NumberType::U16;
  int components = 1;
  std::span<const std::byte> data;  ///< point by point
  bool extra = false;               ///< an ExtraColumn of the source
  double at(std::uint64_t point, int component = 0) const;
};

/// What a store is made of; see PointStore for what it means.
struct PointStoreData {
  Lattice lattice;
  PointSchema schema;
  ScanInfo info;
  LevelKind levelKind = LevelKind::BlueNoise;
  LevelLaw law;
  double lawShift = 0;  ///< level of the law = level + lawShift
  std::vector<CloudNode> nodes;
  struct NodePlace {
    glm::i64vec3 corner{0};  ///< units, of the node's tile
    std::int32_t firstStep = 0;
    std::uint32_t stepCount = 0;
    std::uint64_t tableOffset = 0;
  };
  std::vector<NodePlace> places;  ///< parallel to nodes
  std::span<const std::uint32_t> tables;
  std::span<const DisplayPoint> points;
  std::span<const std::byte> exact;                 ///< the lattice's exact column, where it has one
  std::vector<std::span<const std::byte>> columns;  ///< parallel to schema.columns
  std::shared_ptr<const void> owner;                ///< of everything the spans show
};

/// Points of one scan in the shape that drawing wants: in memory, or mapped from disk. Immutable; thread-safe.
class PointStore {
 public:
  explicit PointStore(PointStoreData data);

  std::uint64_t pointCount() const { return m_data.points.size(); }
  const Bounds& bounds() const { return m_bounds; }
  const ScanInfo& info() const { return m_data.info; }

  /// The root is node 0; children after parents.
  std::span<const CloudNode> nodes() const { return m_data.nodes; }
  std::span<const DisplayPoint> points() const { return m_data.points; }

  /// Median over the points of the spacing of the surface around them (see CloudNode::spacing),
  /// metres; 0 for fewer than two distinct points.
  double medianSpacing() const { return m_medianSpacing; }

  /// Continuous levels: the points below a level are an evenly thinned picture of all. Levels count octaves of
  /// spacing.
  LevelKind levelKind() const { return m_data.levelKind; }
  /// Random levels: the law behind them, in this store's levels shifted by lawShift().
  const LevelLaw& levelLaw() const { return m_data.law; }
  double lawShift() const { return m_data.lawShift; }
  /// Blue noise: metres between neighbours on a surface where all below `level` are drawn (the side of a
  /// square that holds one), as far as the scan is that dense; and its inverse.
  double spacingOfLevel(double level) const;
  double levelOfSpacing(double meters) const;
  NodeLevels levelsOf(std::uint32_t node) const;
  /// The level steps that the node and all nodes below it hold: [lowest, highest).
  std::int32_t lowestStepBelow(std::uint32_t node) const { return m_below[node].low; }
  std::int32_t highestStepBelow(std::uint32_t node) const { return m_below[node].high; }
  /// How many of the node's points lie below the level: continuous (to the next whole point), never
  /// decreasing.
  std::uint32_t countBelow(std::uint32_t node, double level) const;
  /// The level below which this share of all points lies.
  double levelOfShare(double share) const;
  /// Levels that hold points: [from, to).
  double lowestLevel() const { return m_lowestStep / static_cast<double>(kLevelSteps); }
  double highestLevel() const;

  /// The source's own coordinates, bit for bit. Index as in points().
  glm::dvec3 sourcePosition(std::uint64_t point) const;
  /// Where the source has colours: in 8 bits a channel.
  std::optional<glm::u8vec3> sourceColour(std::uint64_t point) const;

  /// Every column of the source beside its coordinates.
  std::span<const AttributeColumn> attributes() const { return m_attributes; }
  /// One that PointBatch has a place for, with the type it has there: "rgb", "intensity", "classification",
  /// "return_number", "return_count", "gps_time", "normal", "scanner", "point_source", "row", "column". Extra
  /// columns, whatever they are called, stand in attributes() alone.
  const AttributeColumn* attribute(std::string_view name) const;
  /// Full brightness of the "rgb" column: 255 or 65535.
  std::uint16_t rgbWhite() const { return m_data.schema.rgbWhite; }
  /// Points [first, first + count) as the source gave them, bit for bit, with all their columns.
  PointBatch batch(std::uint64_t first, std::uint64_t count) const;

  /// The node that holds a point.
  std::uint32_t nodeOf(std::uint64_t point) const;

 private:
  PointStoreData m_data;
  Bounds m_bounds;
  double m_medianSpacing = 0;
  std::vector<AttributeColumn> m_attributes;
  std::vector<std::uint32_t> m_byFirst;  ///< nodes that hold points, ascending by their first
  std::int32_t m_lowestStep = 0;
  struct StepRange {
    std::int32_t low, high;
  };
  std::vector<StepRange> m_below;  ///< by node
  std::vector<std::uint64_t> m_cumulative;  ///< of the whole store, from m_lowestStep
};

/// Collects batches, then builds a store in memory by the same code that indexes scans on disk. One builder a
/// store; not thread-safe.
class PointStoreBuilder {
 public:
  struct Options {
    LevelKind levels = LevelKind::BlueNoise;
    std::uint32_t seed = 1;  ///< of the uniform draw behind random levels
    int dimensions = 3;      ///< n of the level law
    std::uint32_t leafPoints = 20000;
    glm::dvec3 scale{0}, offset{0};  ///< of the source's integers, where it has any (ScanInfo)
    int threads = 0;                 ///< 0: the machine's cores
  };
  PointStoreBuilder();
  explicit PointStoreBuilder(const Options& options);
  ~PointStoreBuilder();

  /// Points that are not finite, or farther than 10^8 m from the origin (no survey's
  /// coordinates are; one such point would cost all others their resolution), are left out and counted.
  void add(const PointBatch& batch);
  void add(PointBatch&& batch);
  std::uint64_t droppedCount() const;

  /// An empty store where no point is left. Fails only when cancelled or when memory runs out.
  /// Consumes what was added.
  Result<std::shared_ptr<const PointStore>> build(const Progress& progress);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
