// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "base/error.h"
#include "plugin_api/yaml_fields.h"

namespace alidade {

/// The text of every value of a calibration file by its key; "camera_matrix.data" for a value one
/// level down, deeper ones belong to that.
///
/// Reads as much of YAML, XML and JSON as OpenCV's FileStorage writes, without FileStorage itself:
/// that one crashes on damaged files (OpenCV 4.6). Nothing here calls itself.
Result<TextFields> parseCalibrationFields(const std::string& text, const std::string& path);

}  // namespace alidade
