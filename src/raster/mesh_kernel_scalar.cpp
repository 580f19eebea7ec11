// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#define ALIDADE_MESH_LANES 4
#include "raster/mesh_kernel_body.h"

namespace alidade {

const MeshKernel kScalarMeshKernel{drawQuads};

}  // namespace alidade
