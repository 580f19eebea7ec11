// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/las_header.h"

namespace alidade {

/// Walks the variable length records behind the header and, from 1.4 on, the extended ones behind
/// the points; fills crs, crsNote, extras and laz. A record that lies about its length is a warning, and
/// ends the walk. A LAZ record of an unknown kind is an error.
Result<void> readLasVlrs(const ByteSource& file, LasHeader& header);

}  // namespace alidade
