// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "survey/design_model.h"
#include "survey/point_batch.h"

namespace alidade {

/// Sixteen quads side by side, as vector units read them. Corners go around the quad; a triangle repeats
/// its last one; a lane without a quad holds NaN. Metres from the origin of the block's station, world axes.
struct OccluderPack {
  static constexpr int kQuads = 16;
  float x[4][kQuads], y[4][kQuads], z[4][kQuads];
};

/// A patch of a scanner's grid, small enough to be culled as one.
struct OccluderBlock {
  glm::vec3 low{0}, high{0};  ///< box of its quads, metres from the station's origin
  std::uint32_t station = 0;
  std::uint32_t firstPack = 0, packCount = 0;
};

/// The surface that structured scans saw, as quads: what hides a design behind it. Plain data, good for any
/// file as it lies; immutable once built.
///
/// Neighbours in a scanner's grid are joined where the step in range is explained by noise or by a plane
/// through the next return on either side, and cut where it exceeds sixty angular steps. A cell of four
/// joined returns is surface; full cells merge by quadtree, up to 16×16, where a plane explains them within
/// the scanner's own noise. A return that cells do not enclose on all sides keeps a square of half a cell
/// around itself, so that thin things stay and edges end half a sample beyond the last return.
struct OccluderMesh {
  std::vector<glm::dvec3> origins;  ///< of the stations, world metres
  std::vector<OccluderBlock> blocks;
  std::vector<OccluderPack> packs;
  std::uint64_t returns = 0;    ///< that the mesh was built from
  std::uint64_t mergedQuads = 0, cellQuads = 0, borderSquares = 0;
  /// Returns without a usable place in a grid: they belong with the unstructured points.
  std::uint64_t withoutGrid = 0;
};

/// The surface of a design's elements, those left out whose globalId is in `hidden`: one block some hundred triangles of an
/// element. Corners in float metres from the design's origin, as the model has them.
OccluderMesh occluderMeshOf(const DesignModel& design, const std::set<std::string>& hidden = {});

/// Collects returns with `row`, `column` and `scanner`, then builds. One builder a mesh; not thread-safe.
/// Memory: 20 bytes a return while collecting, 20 more a cell of the largest grid while building. A grid
/// that would have far more cells than returns is refused and its returns counted as withoutGrid.
class OccluderMeshBuilder {
 public:
  explicit OccluderMeshBuilder(std::vector<Station> stations);
  ~OccluderMeshBuilder();

  /// A batch without row and column holds returns without a grid; without `scanner`, all are station 0's. Of
  /// several returns in one cell the nearest counts.
  void add(const PointBatch& batch);

  /// Consumes what was added.
  OccluderMesh build();

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace alidade
