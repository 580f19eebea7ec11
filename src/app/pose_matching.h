// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plugin_api/reader.h"
#include "survey/project.h"

namespace alidade {

/// Cameras and poses as one or several files gave them.
struct CameraSource {
  std::string path;
  CameraSet set;
  std::vector<FrameId> only = {};  ///< the frames that it may serve (a rig's camera); all where empty
  std::string name = {};           ///< of its only camera; the file's where empty
  std::optional<CameraMount> mount = {};
};

/// A sensor's trajectory as that of a camera on it: cameraFromWorld = cameraFromSensor sensorFromWorld for every pose;
/// times lose `timeOffsetSecs` (trajectory's clock minus the pictures'). The set's only camera is `intrinsics`.
CameraSet rigCameraSet(const CameraSet& sensorTrajectory, const RigidTransform& sensorFromCamera, const Intrinsics& intrinsics,
                       double timeOffsetSecs);

/// Gives every frame of the project the camera and the pose that the sources hold for it:
/// by picture name (with or without its ending, case ignored; of several pictures of one name the one whose folders
/// agree with the picture's path, none where that does not tell), else by time within the trajectory
/// (interpolated, never beyond its ends or across a gap of more than three steps), else by order
/// where the counts agree. A set of one camera and no pictures (a calibration file) serves all frames
/// that have none. A camera without a size of its own takes that of its picture. Frames that already have a pose keep it.
///
/// Returns a sentence for each thing that found no partner, with the next step.
std::vector<std::string> matchPoses(Project& project, const std::vector<CameraSource>& sources);

}  // namespace alidade
