// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/progress.h"
#include "cloud/point_store.h"
#include "plugin_api/scan_writer.h"

namespace alidade {

/// Writes a store as the octree that COPC is: its nodes are the file's, its root cube the file's, so that a node holds the
/// samples of its octave and a leaf all that is left. Nodes above the store's tiles stay empty, as the format allows. Batch by batch: memory does not grow with
/// the store. `info` is what the file says of itself.
/// Returns the sink's remarks.
Result<std::vector<std::string>> writeTree(const PointStore& store, const ScanInfo& info, const ScanNotes& notes, const ScanWriter& writer,
                                           const std::string& path, const Progress& progress);

}  // namespace alidade
