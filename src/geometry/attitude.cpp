// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "geometry/attitude.h"

#include <cmath>

namespace alidade {

namespace {

const glm::dquat kHalfTurnAboutX(0.0, 1.0, 0.0, 0.0);  // photo axes from OpenCV's, and back

glm::dquat aboutX(double angle) { return glm::angleAxis(angle, glm::dvec3(1, 0, 0)); }
glm::dquat aboutY(double angle) { return glm::angleAxis(angle, glm::dvec3(0, 1, 0)); }
glm::dquat aboutZ(double angle) { return glm::angleAxis(angle, glm::dvec3(0, 0, 1)); }

glm::dquat worldFromAircraft(const YawPitchRoll& angles) {
  // Columns: north-east-down's axes in E-N-Up.
  const glm::dmat3 worldFromNed({0, 1, 0}, {1, 0, 0}, {0, 0, -1});
  return glm::quat_cast(worldFromNed) * aboutZ(angles.yaw) * aboutY(angles.pitch) * aboutX(angles.roll);
}

}  // namespace

glm::dquat worldFromCameraRotation(const OmegaPhiKappa& angles) {
  return glm::normalize(aboutX(angles.omega) * aboutY(angles.phi) * aboutZ(angles.kappa) * kHalfTurnAboutX);
}

OmegaPhiKappa omegaPhiKappaOf(const glm::dquat& worldFromCamera) {
  const glm::dmat3 r = glm::mat3_cast(glm::normalize(worldFromCamera * kHalfTurnAboutX));  // r[column][row]
  OmegaPhiKappa angles;
  angles.omega = std::atan2(-r[2][1], r[2][2]);
  angles.phi = std::atan2(r[2][0], std::hypot(r[2][1], r[2][2]));
  // kappa from what omega and phi leave, not from its own entries: near phi = ±pi/2 those are noise.
  const glm::dmat3 rest = glm::mat3_cast(aboutY(-angles.phi) * aboutX(-angles.omega)) * r;
  angles.kappa = std::atan2(rest[0][1], rest[0][0]);
  return angles;
}

glm::dquat worldFromFloorCamera(const YawPitchRoll& angles) {
  // Columns: the camera's right, down and forward in the aircraft's forward, right, down.
  const glm::dmat3 aircraftFromCamera({0, 1, 0}, {-1, 0, 0}, {0, 0, 1});
  return glm::normalize(worldFromAircraft(angles) * glm::quat_cast(aircraftFromCamera));
}

glm::dquat worldFromNoseCamera(const YawPitchRoll& angles) {
  const glm::dmat3 aircraftFromCamera({0, 1, 0}, {0, 0, 1}, {1, 0, 0});
  return glm::normalize(worldFromAircraft(angles) * glm::quat_cast(aircraftFromCamera));
}

}  // namespace alidade
