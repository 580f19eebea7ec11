// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/error.h"
#include "base/image.h"

namespace alidade {

/// Writes an 8-bit PNG, RGB or gray (then the red channel). The same picture gives the same bytes.
Result<void> writePng(const std::string& path, const ColourImage& image, bool colour);

}  // namespace alidade
