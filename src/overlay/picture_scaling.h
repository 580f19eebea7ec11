// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"

namespace alidade {

/// The picture made smaller by averaging what falls into each pixel (a box of the exact size, edges
/// weighted). Width and height at most the picture's and at least 1.
ColourImage shrunk(const ColourImage& picture, int width, int height);

}  // namespace alidade
