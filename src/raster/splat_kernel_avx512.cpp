// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#if defined(__x86_64__)

#define ALIDADE_SPLAT_LANES 16
#include "raster/splat_kernel_body.h"

namespace alidade {

const SplatKernel kAvx512SplatKernel{"AVX-512", draw};

}  // namespace alidade

#endif
