// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "plugin_api/reader.h"

namespace alidade {

/// A COLMAP text model on its way into a CameraSet: COLMAP's own ids lead to indices.
struct ColmapModel {
  CameraSet set;
  std::unordered_map<std::int64_t, int> cameraById;
  std::unordered_map<std::int64_t, int> pictureById;
  std::vector<std::vector<glm::dvec2>> features;  ///< by picture; OpenCV's origin; filled on demand
};

/// Each takes the text of one file; `path` is for error messages. On an Error the model is of no use.
Result<void> parseColmapCameras(std::string_view text, const std::string& path, ColmapModel& model);
Result<void> parseColmapImages(std::string_view text, const std::string& path, bool withFeatures,
                               const Progress& progress, ColmapModel& model);
Result<void> parseColmapPoints(std::string_view text, const std::string& path, const Progress& progress,
                               ColmapModel& model);

}  // namespace alidade
