// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#if defined(__x86_64__)

#define ALIDADE_LANES 16
#include "overlay/paint_compose_body.h"
#include "overlay/paint_edges_body.h"
#include "overlay/paint_faces_body.h"

namespace alidade {

const PaintKernel kAvx512PaintKernel{resolve, resolveSecond, drawEdges, compose};

}  // namespace alidade

#endif
