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
struct CloudNode {
  glm::dvec3 origin{0};  ///< world metres of the cube's low corner: position = origin + xyz * step
  double step = 0;       ///< metres a 16-bit unit
  double size = 0;       ///< edge of the cube, metres
  Bounds bounds;         ///< of the points themselves, world
  std::uint32_t depth = 0;
  std::int32_t firstChild = -1;  ///< children are contiguous: [firstChild, firstChild + childCount)
  std::uint32_t childCount = 0;
  std::uint64_t first = 0;       ///< into points()
  std::uint32_t count = 0;
  double spacing = 0;            ///< metres between neighbours when all of the node is drawn
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

  /// Median distance from a point to its nearest neighbours over the whole cloud, metres.
  virtual double medianSpacing() const = 0;

  /// The source's own coordinates, bit for bit. Index as in points().
  virtual glm::dvec3 sourcePosition(std::uint64_t point) const = 0;
  /// The point's place in the source, counted over all batches from 0.
  virtual std::uint64_t sourceIndex(std::uint64_t point) const = 0;
  virtual std::optional<glm::u8vec3> sourceColour(std::uint64_t point) const = 0;
};

/// Collects batches, then builds. One builder a store; not thread-safe.
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

  /// Non-finite points are left out and counted.
  void add(const PointBatch& batch);
  std::uint64_t droppedCount() const;

  Result<std::shared_ptr<const PointStore>> build(const Progress& progress);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
