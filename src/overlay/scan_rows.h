// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "base/image.h"
#include "camera/camera.h"
#include "camera/rolling_shutter.h"

namespace alidade {

/// Turns what the scan's points give for the pose of the middle row into what a camera sees that reads its rows one after the
/// other (camera/rolling_shutter.h): each pixel looks up, along its ray at its own row's pose, where the middle row's picture
/// shows what lies there. Depths become those along the axis of the row's camera. What only the row's pose would see, beside an
/// edge, is taken from what the middle row's sees there; where nothing is known, the pixel moves as if it were far away.
///
/// `depth` has the camera's size, `colour` too or is empty. Unchanged where the shutter is not on.
void moveToRows(const Camera& camera, const RollingShutter& shutter, DepthImage& depth, ColourImage& colour);

}  // namespace alidade
