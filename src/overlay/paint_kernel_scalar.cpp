// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#define ALIDADE_LANES 4
#include "overlay/paint_compose_body.h"
#include "overlay/paint_edges_body.h"
#include "overlay/paint_faces_body.h"

namespace alidade {

const PaintKernel kScalarPaintKernel{resolve, resolveSecond, drawEdges, compose};

}  // namespace alidade
