// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// A camera as the EuRoC data sets describe it.
struct EurocSensor {
  Intrinsics intrinsics;
  RigidTransform bodyFromSensor;  ///< T_BS; the sensor's axes are OpenCV's
};

/// A camera's `sensor.yaml` of the EuRoC data sets (ASL format; Burri et al., The EuRoC micro aerial vehicle datasets, 2016):
/// `intrinsics` fu fv cu cv, `resolution`, `distortion_model` radial-tangential (k1 k2 p1 p2) or equidistant (OpenCV's
/// fisheye) with four `distortion_coefficients`, and `T_BS`, a 4 × 4 matrix row by row. The pixel origin is OpenCV's.
///
/// Refused: a sensor that is no camera, another camera or lens model, a matrix that is no rigid transform, what is
/// missing or no finite number.
Result<EurocSensor> parseEurocSensor(std::string_view text, const std::string& path);

/// That of a file; nothing where it is none, by its words.
Result<std::optional<EurocSensor>> readEurocSensor(const std::string& path);

/// Whether the beginning of a file looks like one.
bool looksLikeEurocSensor(std::string_view head);

}  // namespace alidade
