// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "overlay/frame_description.h"
#include "plugin_api/reader.h"
#include "survey/project.h"

namespace alidade {

/// A scan ready to draw: its points in levels, what their attributes hold, and the surface that its
/// scanners saw where their grid is known. One layer a part of its store. `number` counts the scans.
Result<std::vector<ScanLayer>> loadScan(const Scan& scan, int number, std::vector<ImportWarning>& warnings,
                                        const Progress& progress);

/// A picture of a large scan before it is read whole, within about a second: an even sample where the format allows one, else what was
/// read until then. Empty for a scan that is quicker read than sampled, and for a point store.
Result<std::vector<ScanLayer>> sampleScan(const Scan& scan, int number, const Progress& progress);

}  // namespace alidade
