// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "plugin_api/reader.h"
#include "survey/point_batch.h"
#include "survey/scan_notes.h"

namespace alidade {

/// A cell of an octree over a cube: the cube cut 2^depth times an axis. Formats that are trees (COPC)
/// keep it; the others ignore it.
struct OctreeCell {
  int depth = 0;
  std::int32_t x = 0, y = 0, z = 0;
  friend bool operator==(const OctreeCell&, const OctreeCell&) = default;
};

/// What is written beside the points.
struct ScanWriteOptions {
  ScanInfo info;  ///< CRS, scale, offset, stations; a scale of 0 means the finest power of ten, 1e-9 m at
                  ///< least, that reaches well over the bounds
  ScanNotes notes;
  /// The cube that the cells count in: corner and edge, metres. Set where cells are given.
  glm::dvec3 cubeCorner{0};
  double cubeSize = 0;
  double rootSpacing = 0;  ///< metres between points of the tree's root; 0: unknown
};

/// A file being written. It appears under its name only when `finish` succeeds; dropped before, it
/// leaves nothing behind.
class ScanSink {
 public:
  virtual ~ScanSink() = default;
  /// `cell` says which octree cell all of these points belong to; one cell may come in several calls, one
  /// after the other. Tree formats fail without it.
  virtual Result<void> add(const PointBatch& batch, const std::optional<OctreeCell>& cell) = 0;
  virtual Result<void> finish() = 0;
  /// What the format could not keep as it was; complete after `finish`.
  virtual std::vector<std::string> remarks() const { return {}; }
};

/// Writes scans of one format. Like a Reader it has no state and every method is thread-safe.
class ScanWriter {
 public:
  virtual ~ScanWriter() = default;
  virtual ReaderDescription description() const = 0;
  /// True for a path that this format is asked for by its name ("site.copc.laz").
  virtual bool writes(const std::string& path) const = 0;
  /// True where `add` needs cells.
  virtual bool isTree() const = 0;
  virtual Result<std::unique_ptr<ScanSink>> create(const std::string& path, const ScanWriteOptions& options) const = 0;
};

}  // namespace alidade
