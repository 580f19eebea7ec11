// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#define ALIDADE_LANES 4
#include "raster/triangle_kernel_body.h"

namespace alidade {

// Four lanes are what every 64-bit processor has; on others the compiler takes them apart.
const TriangleKernel kScalarTriangleKernel{"scalar", projectCorners, projectPoints, draw, drawSecond};

}  // namespace alidade
