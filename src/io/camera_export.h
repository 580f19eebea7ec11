// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "survey/project.h"

namespace alidade {

enum class CameraFormat {
  Colmap,      ///< a folder with cameras.txt, images.txt, points3D.txt: pixels from the corner of the top-left pixel (+ 0.5)
  Transforms,  ///< transforms.json of Nerfstudio and instant-ngp: OpenGL axes, world from camera, pixels + 0.5
  Table        ///< CSV: name, x, y, z, omega, phi, kappa in degrees, time; no lenses
};

/// "*.json" and "*.csv" by their ending, anything else is a folder for COLMAP.
CameraFormat cameraFormatOf(const std::string& path);

struct CameraExport {
  std::size_t frames = 0, cameras = 0, points = 0;
  std::vector<std::string> notes;  ///< what was left out, each with its reason
};

/// Writes every frame that has a camera and a pose, and for COLMAP the enabled observations as points. Numbers are
/// written so that reading gives them back bit for bit. Each file appears whole or not at all.
///
/// Error where no frame can be written, two frames cannot be told apart by name, or a lens cannot be said in the
/// format: the message names the camera and the coefficient.
Result<CameraExport> exportCameras(const Project& project, CameraFormat format, const std::string& path);

}  // namespace alidade
