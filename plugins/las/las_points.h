// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/las_header.h"
#include "survey/point_batch.h"

namespace alidade {

/// True where the colours are 8-bit numbers stored without the shift that the standard asks for: no
/// channel of any point exceeds 255, and some are not 0. A sample over the file settles the usual
/// case; only a file that looks unshifted is looked through to the end.
Result<bool> lasColoursAreUnshifted(const InputFile& file, const LasHeader& header, const Progress& progress);

/// Fills the batch from `count` point records. The batch's columns are reused between calls.
void decodeLasPoints(const LasHeader& header, const std::byte* records, std::size_t count, bool unshiftedColours,
                     PointBatch& batch);

/// How many points are read at a time.
std::size_t lasBatchSize(const LasHeader& header);

}  // namespace alidade
