// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/camera_export.h"

namespace alidade {

/// What of a project is exported, and under which names.
struct ExportedFrame {
  const Frame* frame = nullptr;
  std::size_t camera = 0;  ///< index into ExportedSet::cameras
  std::string name;        ///< distinct
};

struct ExportedSet {
  std::vector<const CameraRecord*> cameras;
  std::vector<ExportedFrame> frames;
};

Result<void> writeAtomically(const std::string& path, std::string_view text);

/// The first coefficient that is not 0 beyond the named ones ("k1 k2 p1"); empty where there is none.
std::string coefficientBeyond(const Distortion& distortion, std::string_view allowed);

/// A line of COLMAP's cameras.txt, in the camera's own model where COLMAP has it, else in the smallest that holds its
/// coefficients.
Result<std::string> colmapCameraLine(std::size_t id, const Intrinsics& intrinsics);

Result<void> writeColmap(const Project& project, const ExportedSet& set, const std::string& folder, CameraExport& done);
Result<void> writeTransforms(const ExportedSet& set, const std::string& path);
Result<void> writePoseTable(const ExportedSet& set, const std::string& path);

}  // namespace alidade
