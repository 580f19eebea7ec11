// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"

namespace alidade {

struct ScanConversion {
  std::string format;  ///< what was written
  std::uint64_t points = 0, dropped = 0;
  std::vector<std::string> warnings;
};

/// Writes scans, stores among them, into one file in the format of its name, with all their columns (see joinScans).
/// COPC is written from a store's own tree; of anything else but one store of one part a store is made first, for the while, beside
/// the file. Memory: batches, or what indexing may take. A file that is there is replaced at the very end only.
Result<ScanConversion> convertScans(const std::vector<std::string>& scans, const std::string& target, const Progress& progress);

}  // namespace alidade
