// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/cell_tree.h"
#include "cloud/lattice.h"
#include "cloud/point_schema.h"
#include "cloud/scan_source.h"

namespace alidade {

/// Where a part's columns go: memory or files. `write` and `read` are called from several threads for
/// ranges that do not overlap.
class PartSink {
 public:
  /// Fixed columns; the schema's own follow from kFirstAttribute.
  enum Column : std::size_t { kPoints = 0, kExact = 1, kTables = 2, kTops = 3, kFirstAttribute = 4 };

  virtual ~PartSink() = default;
  /// Before anything is written. `resumed`: what stands there already is kept.
  virtual Result<void> begin(std::uint64_t pointCount, const Lattice& lattice, const PointSchema& schema, bool resumed) = 0;
  virtual Result<void> write(std::size_t column, std::uint64_t offset, std::span<const std::byte> bytes) = 0;
  /// What was written before; only of kTops.
  virtual Result<void> read(std::size_t column, std::uint64_t offset, std::span<std::byte> into) = 0;

  /// The work's own diary, for going on after a kill: entries as they were added. A sink in memory keeps none.
  virtual std::vector<std::vector<std::byte>> diary() { return {}; }
  virtual Result<void> note(std::span<const std::byte>) { return {}; }
  /// Path of a temporary file for points that do not fit into memory; empty: there is none.
  virtual std::string spillPath() const { return {}; }
};

struct PartOptions {
  TreeOptions tree;                     ///< law and lawShift are filled in
  int dimensions = 3;                   ///< n of the level law
  int threads = 2;
  std::uint64_t memoryBytes = std::uint64_t{2} << 30;
  std::uint64_t cellPoints = 500'000;
};

/// Cells for a scan of this many points: small clouds, too, are worth all cores.
std::uint64_t cellPointsFor(std::uint64_t pointCount);

/// A part as it was built; nodes[0] is the root, children stand side by side after their parents.
struct PartTree {
  Lattice lattice;
  PointSchema schema;
  TreeOptions tree;
  std::vector<BuildNode> nodes;
  std::uint64_t pointCount = 0, dropped = 0;
  std::uint64_t tableCount = 0;
};

/// Turns a scan into a tree of points: the one way there is, for stores in memory and on disk.
///
/// 1. A sample decides the lattice, the columns and the cells (lattice.h, chunk_plan.h).
/// 2. Every point goes to its cell's stream (distribution.h), in memory or spilled.
/// 3. Streams become subtrees, several at a time (cell_tree.h). A cell sees the border samples of
///    neighbours whose streams have an earlier colour in a greedy colouring: the result depends on
///    neither threads nor memory.
/// 4. What the cells of a cut tile left over becomes the tree above them.
Result<PartTree> indexPart(const ScanSource& source, const PartOptions& options, PartSink& sink, const Progress& progress);

}  // namespace alidade
