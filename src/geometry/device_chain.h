// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "geometry/rigid_transform.h"

namespace alidade {

/// Where a camera sits on a measuring device whose sensor's poses are known (Gantner 2018, "Virtual
/// camera for input video"):
///
///     t_CinW = t_SinW + R_WS t_CinD
///     R_WC   = R_WS R_WD R_DC,   R_WD a turn by +90° about x
///
/// The position is added in the sensor's axes as it stands; the attitude passes through R_WD, because
/// the device states attitudes in axes of its own.
struct DeviceOffset {
  glm::dvec3 cameraInDevice{0};                     ///< t_CinD, metres
  glm::dquat deviceFromCamera{1.0, 0.0, 0.0, 0.0};  ///< R_DC
};

/// The chain as one transform: worldFromCamera = worldFromSensor * sensorFromCamera(offset).
RigidTransform sensorFromCamera(const DeviceOffset& offset);

}  // namespace alidade
