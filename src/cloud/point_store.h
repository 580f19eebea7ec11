// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/levels.h"
#include "geometry/bounds.h"
#include "survey/point_batch.h"

namespace alidade {

/// What is read per point while drawing: 16-bit position in its node's cube and RGB565.
struct DisplayPoint {
  std::uint16_t x, y, z;
  std::uint16_t rgb565;
};
static_assert(sizeof(DisplayPoint) == 8);

/// A cube of the octree with the points whose level falls to it, sorted by continuous level: any
/// prefix of [first, first+count) is a coarser picture of the node.
///
/// A node at depth d holds the samples of level below d+1 that no ancestor holds; a leaf holds all
/// that is left. A node whose 16-bit step would exceed a millimetre, or that would hold too many
/// points to be culled well, holds none and leaves them to its children. Cells with one occupied
/// octant are skipped, so a child may be more than one depth below its parent.
struct CloudNode {
  /// World metres: position = origin + xyz * step. Half a step inside the cube's low corner, so that
  /// a display position is at most step/2 from its source in each axis.
  glm::dvec3 origin{0};
  double step = 0;               ///< metres a 16-bit unit; a power of two
  double size = 0;               ///< edge of the cube, metres: 65536 steps
  Bounds bounds;                 ///< of the source points in the node and in all below it, world
  std::uint32_t depth = 0;       ///< size = root size / 2^depth
  std::int32_t firstChild = -1;  ///< children are contiguous: [firstChild, firstChild + childCount)
  std::uint32_t childCount = 0;
  std::uint64_t first = 0;  ///< into points()
  std::uint32_t count = 0;
  /// Metres between neighbours here when every level is drawn: the side of a square of surface that
  /// holds one point. When a share F of the levels is drawn it is spacing / sqrt(F).
  double spacing = 0;
};

/// Points of one or more scans in the shape that drawing wants. Immutable once built; thread-safe.
class PointStore {
 public:
  virtual ~PointStore() = default;

  virtual std::uint64_t pointCount() const = 0;
  virtual const Bounds& bounds() const = 0;
  virtual const LevelLaw& levelLaw() const = 0;

  /// The root is node 0; children after parents.
  virtual std::span<const CloudNode> nodes() const = 0;
  virtual std::span<const DisplayPoint> points() const = 0;
  /// Continuous level of each point, parallel to points(); ascending inside a node.
  virtual std::span<const float> levels() const = 0;

  /// Median over the points of the spacing of the surface around them (see CloudNode::spacing),
  /// metres; 0 for fewer than two distinct points.
  virtual double medianSpacing() const = 0;

  /// The source's own coordinates, bit for bit. Index as in points().
  virtual glm::dvec3 sourcePosition(std::uint64_t point) const = 0;
  /// The point's place in the source, counted over all batches from 0.
  virtual std::uint64_t sourceIndex(std::uint64_t point) const = 0;
  virtual std::optional<glm::u8vec3> sourceColour(std::uint64_t point) const = 0;
};

/// Collects batches, then builds a store in memory. One builder a store; not thread-safe.
///
/// Memory: 28 bytes a point while collecting, 60 at the peak of build(), 44 afterwards (24 of them
/// the source's own doubles), plus the nodes. Fewer than 2^32 points.
class PointStoreBuilder {
 public:
  struct Options {
    std::uint32_t seed = 1;  ///< of the uniform draw behind the levels
    int dimensions = 3;      ///< n of the level law
    std::uint32_t leafPoints = 20000;
  };
  PointStoreBuilder();
  explicit PointStoreBuilder(const Options& options);
  ~PointStoreBuilder();

  /// Points that are not finite, or farther than 10^8 m from the origin (no survey's
  /// coordinates are; one such point would cost all others their resolution), are left out and counted.
  void add(const PointBatch& batch);
  std::uint64_t droppedCount() const;

  /// An empty store where no point is left. Fails only when cancelled, for too many points or when
  /// memory runs out. Consumes what was added.
  Result<std::shared_ptr<const PointStore>> build(const Progress& progress);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
