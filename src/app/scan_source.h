// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "cloud/scan_source.h"
#include "plugin_api/reader.h"

namespace alidade {

/// A scan's file as the indexer wants it. `reader` and `warnings` (may be null; each warning once, however often
/// the file is read) outlive it. The identity names the file, its size and its time.
ScanSource scanSourceOf(const ScanReader& reader, const std::string& path, const ScanInfo& info,
                        std::vector<ImportWarning>* warnings);

/// A scan by its path: a file of any format that is read, or a point store, whose parts come as one scan (see joinScans).
/// Error where it cannot be opened. `warnings` as above.
Result<ScanSource> openScan(const std::string& path, std::vector<ImportWarning>* warnings);

}  // namespace alidade
