// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/las_header.h"

namespace alidade {

/// Walks the variable length records behind the header and, from 1.4 on, the extended ones behind
/// the points; fills crs, crsNote and extras. A record that lies about its length is a warning, and
/// ends the walk. LAZ's record is an error that says what to do.
Result<void> readLasVlrs(const InputFile& file, LasHeader& header);

/// What a compressed file is told.
Error lazRefusal(const std::string& path);

}  // namespace alidade
