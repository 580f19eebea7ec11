// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "cloud/scan_source.h"
#include "plugin_api/reader.h"

namespace alidade {

/// Several scans as one, one after the other: stations in their order, coordinate steps as fine as the finest, and every
/// batch with every column that the first batch of any of them has (zero where a scan has none; scanner 65535). Error where
/// there are none, where their coordinate systems differ, and where a first batch cannot be read.
/// What is lost beside the points goes to `warnings` (may be null).
Result<ScanSource> joinScans(std::vector<ScanSource> scans, std::vector<ImportWarning>* warnings);

}  // namespace alidade
