// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"

namespace alidade {

/// "frame_0000.png"
std::string frameFileName(int frame);

/// COLMAP text model (cameras.txt, images.txt, points3D.txt): FULL_OPENCV, world to camera, pixel origin at
/// the corner of the top-left pixel.
Result<void> writeColmapModel(const std::string& folder, const Intrinsics& intrinsics,
                              const std::vector<RigidTransform>& cameraFromWorld);

/// TUM trajectory: `time tx ty tz qx qy qz qw`, camera to world, from `startSecs`.
Result<void> writeTrajectory(const std::string& path, const std::vector<RigidTransform>& cameraFromWorld,
                             double posesPerSecond, double startSecs);

/// The lens as OpenCV's FileStorage keeps it: image_width, image_height, camera_matrix, distortion_coefficients (five).
Result<void> writeCalibration(const std::string& path, const Intrinsics& intrinsics);

}  // namespace alidade
