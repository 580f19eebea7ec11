// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"
#include "base/progress.h"

namespace alidade::cli {

/// What standard input holds, `columns` numbers a line between blanks, tabs, commas or semicolons; # starts a remark. What
/// stands behind the numbers of a line is left alone. `what` and `names` say it in words: "points", "E N H".
Result<std::vector<std::vector<double>>> rowsFromInput(std::size_t columns, const char* what, const char* names, const Progress& progress);

}  // namespace alidade::cli
