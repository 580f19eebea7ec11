// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"

namespace alidade::cli {

/// "1,2.5,-3" as from `least` to `most` finite numbers; `advice` tells which ones `option` wants.
Result<std::vector<double>> numberList(const std::string& text, std::size_t least, std::size_t most, const char* option, const char* advice);

/// "a,b,c" cut at its commas.
std::vector<std::string> wordList(const std::string& text);

}  // namespace alidade::cli
