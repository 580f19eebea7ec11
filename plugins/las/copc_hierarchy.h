// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "las/las_header.h"
#include "plugin_api/scan_writer.h"

namespace alidade {

/// One node of a COPC file that has points.
struct CopcNode {
  OctreeCell cell;
  Bounds cube;         ///< world metres
  double spacing = 0;  ///< metres between its points
  LasRun run;          ///< its chunk
};

/// Which nodes are asked for.
struct CopcQuery {
  Bounds region;              ///< nodes that touch it; empty: all
  int deepest = 31;           ///< level
  double finestSpacing = 0;   ///< metres; nodes that are finer than their parents already satisfy are left out
};

/// The octree of a COPC file (https://copc.io, "Hierarchy VLR"): pages of entries, of which only those are read that
/// a query needs, so that it may stand on a server.
class CopcHierarchy {
 public:
  /// Both must outlive it; header.copc must be there.
  CopcHierarchy(const ByteSource& file, const LasHeader& header) : m_file(file), m_header(header) {}

  Bounds cubeOf(const OctreeCell& cell) const;
  double spacingOf(int depth) const;

  /// Coarse levels first, and within a level by offset in the file. Error where an entry or a page lies outside
  /// of the file or pages run in circles.
  Result<std::vector<CopcNode>> nodes(const CopcQuery& query) const;

  /// The runs of the coarsest nodes that together hold about `wanted` points; of the last level a share of each node.
  Result<std::vector<LasRun>> coarsest(std::uint64_t wanted) const;

 private:
  bool matches(const OctreeCell& cell, const CopcQuery& query) const;

  const ByteSource& m_file;
  const LasHeader& m_header;
};

}  // namespace alidade
