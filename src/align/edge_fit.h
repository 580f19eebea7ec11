// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "align/fine_fit.h"

namespace alidade {

/// The last fit of a picture to a scene without colours, from a pose a few pixels off at most: places along the edges of
/// the drawn surfaces are looked for across them in the photo's edges (`level.luma` from photoEdges()), the way narrowing
/// with each step; each place knows the direction across its edge alone. After Drummond and Cipolla (2002), Real-time
/// visual tracking of complex structures.
FineFit fitEdges(const AlignmentScene& scene, const PictureLevel& level, const RigidTransform& cameraFromWorld,
                 const PoseKnowledge& known);

}  // namespace alidade
