// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/device_chain.h"

#include <numbers>

namespace alidade {

RigidTransform sensorFromCamera(const DeviceOffset& offset) {
  const glm::dquat quarterTurnAboutX(std::numbers::sqrt2 / 2, std::numbers::sqrt2 / 2, 0.0, 0.0);
  return {glm::normalize(quarterTurnAboutX * offset.deviceFromCamera), offset.cameraInDevice};
}

}  // namespace alidade
