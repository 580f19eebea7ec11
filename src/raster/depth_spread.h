// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"

namespace alidade {

/// A depth image twice as wide and high: between pixels of one surface (depths within 3 %) the depth in between,
/// elsewhere the nearest pixel's, so that no edge is smeared and nothing unknown (NaN) is made up.
DepthImage spreadDepth(const DepthImage& half);

}  // namespace alidade
