// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#if defined(__x86_64__)

#define ALIDADE_LANES 16
#include "raster/triangle_kernel_body.h"

namespace alidade {

const TriangleKernel kAvx512TriangleKernel{"AVX-512", projectCorners, projectPoints, draw, drawSecond};

}  // namespace alidade

#endif
