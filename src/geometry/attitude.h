// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace alidade {

// Attitudes as surveyors write them, in radians. World is E-N-Up; a camera's axes are OpenCV's (x right,
// y down, z forward); a rotation worldFromCamera turns camera axes into world axes.

/// Kraus, Photogrammetry: worldFromPhoto = Rx(omega) Ry(phi) Rz(kappa), photo axes x right, y up, z against
/// the view. All 0: a camera that looks straight down, the picture's top to the north.
struct OmegaPhiKappa {
  double omega = 0, phi = 0, kappa = 0;
};
glm::dquat worldFromCameraRotation(const OmegaPhiKappa& angles);
/// phi within ±pi/2. Where phi is ±pi/2 only omega ± kappa is determined: the angles give the rotation back all the same.
OmegaPhiKappa omegaPhiKappaOf(const glm::dquat& worldFromCamera);

/// Yaw clockwise from north, pitch nose up, roll right side down: Rz(yaw) Ry(pitch) Rx(roll) from an
/// aircraft's axes (forward, right, down) to north-east-down.
struct YawPitchRoll {
  double yaw = 0, pitch = 0, roll = 0;
};
/// The camera looks out of the aircraft's floor, the picture's top to the nose: all 0 looks straight
/// down (Metashape, Pix4D).
glm::dquat worldFromFloorCamera(const YawPitchRoll& angles);
/// The camera looks along the nose: all 0 looks north, level; pitch -pi/2 straight down (gimbals).
glm::dquat worldFromNoseCamera(const YawPitchRoll& angles);

}  // namespace alidade
