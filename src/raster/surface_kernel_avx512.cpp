// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#if defined(__x86_64__)

#define ALIDADE_SURFACE_LANES 16
#include "raster/surface_kernel_body.h"

namespace alidade {

const SurfaceKernel kAvx512SurfaceKernel{takeDepths, takePixels, takeColours, takePlaces, toMiddles, pull, takeNearer, takeCoarser, closeHoles};

}  // namespace alidade

#endif
