// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// One camera that sits on a sensor whose poses are known.
struct RigCamera {
  std::string name;
  std::string pictures;     ///< folder or video, absolute
  std::string calibration;  ///< any file of cameras that describes one, absolute
  std::optional<RigidTransform> sensorFromCamera;  ///< nothing: the calibration says it (EuRoC's T_BS)
  double startSecs = 0;     ///< time of the first picture, where rateHz is given
  std::optional<double> rateHz;
};

/// Cameras on one sensor, and the sensor's trajectory.
struct Rig {
  std::string trajectory;      ///< any file of poses, absolute: they are the sensor's
  double timeOffsetSecs = 0;   ///< trajectory's clock minus the pictures' clock
  std::vector<RigCamera> cameras;
};

/// A rig file, JSON; paths are relative to it. Positions are metres, quaternions w x y z:
///
///     { "alidade_rig": 1,
///       "trajectory": "trajectory.txt",
///       "time_offset_s": 0.02,
///       "cameras": [
///         { "name": "left", "pictures": "left", "calibration": "left.yml", "rate_hz": 15, "start_s": 0.5,
///           "sensor_from_camera": { "position_m": [0.1, 0, 0.05], "rotation_wxyz": [1, 0, 0, 0] } },
///         { "name": "right", "pictures": "right", "calibration": "right.yml", "camera_axes": "opengl",
///           "device": { "camera_in_device_m": [-0.1, 0, 0.05], "device_from_camera_wxyz": [1, 0, 0, 0] } } ] }
///
/// `sensor_from_camera` is the plain mounting; `device` goes through the chain of geometry/device_chain.h. Camera axes
/// are OpenCV's unless `camera_axes` says "opengl" (y up, z backwards). `time_offset_s`, `rate_hz`, `start_s` and
/// `camera_axes` may be left out, and so may the mounting where the calibration says it (EuRoC's sensor.yaml); without `rate_hz` pictures have the times of their video, or go by order.
///
/// Error, with the camera and the key, where a key is missing, unknown or no number.
Result<Rig> readRigFile(const std::string& path);
Result<Rig> parseRig(const std::string& text, const std::string& path);

}  // namespace alidade
