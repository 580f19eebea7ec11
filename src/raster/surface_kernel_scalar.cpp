// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#define ALIDADE_SURFACE_LANES 4
#include "raster/surface_kernel_body.h"

namespace alidade {

const SurfaceKernel kScalarSurfaceKernel{takeDepths, takePixels, takeColours, takePlaces, toMiddles, pull, takeNearer, takeCoarser, closeHoles};

}  // namespace alidade
