// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/progress.h"
#include "plugin_api/scan_writer.h"

namespace alidade::cli {

/// Points in memory, put into an octree as COPC wants it: every node holds at most one point of each cell of a grid
/// of 128 over its edge, the first that came; what is left goes to the eight below, and few enough points stay together.
class CopcTree {
 public:
  void add(PointBatch&& batch);
  std::uint64_t pointCount() const { return m_count; }

  /// Options' cube and spacing are set here.
  Result<void> write(const ScanWriter& writer, const std::string& path, ScanWriteOptions options, const Progress& progress);

 private:
  std::vector<PointBatch> m_batches;
  std::uint64_t m_count = 0;
};

}  // namespace alidade::cli
