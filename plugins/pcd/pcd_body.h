// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>

#include "pcd/pcd_header.h"

namespace alidade {

/// Takes one value a field (0 for fields of several numbers) and returns false to stop.
using PcdRow = std::function<bool(const double*)>;

/// Error where the rest of the file cannot hold the points, naming both numbers.
Result<void> checkPcdRoom(const ByteStream& stream, const PcdHeader& header, const std::string& path);

/// Hands over every point of the file, in order.
Result<void> readPcdRows(ByteStream& stream, const PcdHeader& header, const std::string& path, const PcdRow& row);

}  // namespace alidade
