// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

#include "plugin_api/reader.h"

namespace alidade {

/// One calibrated camera as OpenCV's FileStorage writes it: YAML, XML or JSON with image_width,
/// image_height, camera_matrix (3×3) and distortion_coefficients (4, 5, 8, 12 or 14 numbers, or 4 with
/// the key fisheye_model set). The spellings of OpenCV's older samples and of ROS's camera_info
/// (distortion_model: plumb_bob, rational_polynomial, equidistant, fisheye) are read, too. Pixels are
/// OpenCV's already.
///
/// Refused, by the key's name: a missing key, a matrix of another shape, a value that is no finite
/// number, a last row other than 0 0 1. A skew in the camera matrix is passed over with a warning,
/// as OpenCV itself does.
class OpenCvCalibrationReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The same of a text in memory; `path` is for messages.
Result<CameraSet> parseOpenCvCalibration(const std::string& text, const std::string& path);

}  // namespace alidade
