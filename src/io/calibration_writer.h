// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/error.h"
#include "camera/camera.h"

namespace alidade {

/// What else a calibration file can say of itself.
struct CalibrationRemarks {
  double rmsPx = 0;   ///< 0: not known
  int pictures = 0;
};

/// One camera as OpenCV's FileStorage writes it: YAML (*.yml, *.yaml), XML (*.xml) or JSON (*.json) with image_width,
/// image_height, camera_matrix, distortion_coefficients, fisheye_model for that lens, and
/// avg_reprojection_error; or COLMAP's cameras.txt (*.txt, pixels + 0.5). Numbers are read back bit for bit; the file
/// appears whole or not at all.
///
/// Error for another ending, and for a lens that the format has no word for: the message names the coefficient.
Result<void> writeCalibration(const Intrinsics& intrinsics, const CalibrationRemarks& remarks, const std::string& path);

}  // namespace alidade
