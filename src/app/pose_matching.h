// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "plugin_api/reader.h"
#include "survey/project.h"

namespace alidade {

/// Cameras and poses as one or several files gave them.
struct CameraSource {
  std::string path;
  CameraSet set;
};

/// Gives every frame of the project the camera and the pose that the sources hold for it:
/// by picture name (with or without its ending, case ignored), else by time within the trajectory
/// (interpolated, never beyond its ends or across a gap of more than three steps), else by order
/// where the counts agree. A set of one camera and no pictures (a calibration file) serves all frames
/// of its size that have none. Frames that already have a pose keep it.
///
/// Returns a sentence for each thing that found no partner, with the next step.
std::vector<std::string> matchPoses(Project& project, const std::vector<CameraSource>& sources);

}  // namespace alidade
