// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "app/scan_cleaning.h"
#include "overlay/frame_description.h"
#include "plugin_api/reader.h"
#include "survey/project.h"

namespace alidade {

/// A scan made from one of a project's, in a file of its own, and ready to draw. The scan that it was made from and its file stay
/// as they are: whoever takes this one into the project hides that one, and taking it back is undo.
struct DerivedScan {
  Scan scan;  ///< without an id
  std::vector<ScanLayer> layers;
  std::vector<ImportWarning> warnings;
  std::string report;  ///< lines for a reader
};

/// Cleans a scan (see cleanScan) into a new LAZ file in the project's folder, or beside the scan where the project is not saved yet.
Result<DerivedScan> deriveCleaned(const Project& project, ScanId scan, const ScanCleaning& cleaning, const Progress& progress);

/// Fits a scan to another (see registerScan) and writes it, moved, as above.
Result<DerivedScan> deriveRegistered(const Project& project, ScanId moving, ScanId fixed, const RegistrationOptions& options, const Progress& progress);

}  // namespace alidade
