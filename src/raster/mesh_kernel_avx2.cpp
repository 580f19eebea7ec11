// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#if defined(__x86_64__)

#define ALIDADE_MESH_LANES 8
#include "raster/mesh_kernel_body.h"

namespace alidade {

const MeshKernel kAvx2MeshKernel{drawQuads};

}  // namespace alidade

#endif
