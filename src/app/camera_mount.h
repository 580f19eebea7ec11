// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "base/error.h"
#include "survey/project.h"

namespace alidade {

/// A mount as people write it.
struct MountFigures {
  std::string body;
  glm::dvec3 positionM{0};      ///< of the camera's centre, in the body's axes
  /// bodyFromCamera = Rx(omega) Ry(phi) Rz(kappa), radians; all 0: the camera's axes are the body's. phi within ±pi/2.
  glm::dvec3 anglesRad{0};
  glm::dvec3 positionStdM{0};   ///< along the camera's x, y, z; 0: not known
  glm::dvec3 anglesStdRad{0};   ///< about the camera's x, y, z
  friend bool operator==(const MountFigures&, const MountFigures&) = default;
};
MountFigures figuresOf(const CameraMount& mount);
/// Error where a figure is not finite, the camera would sit more than a kilometre off, a standard deviation is negative,
/// or the body has no name.
Result<CameraMount> mountOf(const MountFigures& figures);

/// Puts a camera elsewhere on its body; nothing takes it off. The trajectories that serve its frames were moved from the
/// body's place to the camera's: they follow, and with them the frames whose poses are interpolated on them; a refined
/// pose stays. A camera without a mount is taken for one that sits where its body is. A mount that names another body only tells where the
/// camera is from there: nothing moves. Error where the project has no such camera,
/// or where such a trajectory serves frames of other cameras, too; the project is unchanged then. Tells how many frames followed.
Result<int> setMount(Project& project, CameraId camera, const std::optional<CameraMount>& mount);

}  // namespace alidade
