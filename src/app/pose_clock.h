// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <optional>
#include <string>

#include "base/error.h"
#include "camera/rolling_shutter.h"
#include "survey/project.h"

namespace alidade {

/// What a trajectory gave its frames.
struct PoseCount {
  std::size_t posed = 0;
  std::map<PoseGap, std::size_t> without;  ///< frames without a pose, by the reason
};
/// "88 frames have a pose; 2 have none: after the trajectory ends".
std::string poseCountText(const PoseCount& count);

/// Interpolates the pose of every frame that the trajectory serves, at the frame's time plus the clock offset. A
/// refined pose stays; a frame where the trajectory has none loses the one it had from it.
PoseCount poseFromTrajectory(Project& project, TrajectoryId trajectory);

/// The same with another offset; `stdSecs` where it was estimated. Error where the project has no such trajectory,
/// the offset is no time, or none of the trajectory's frames would have a pose; the project is unchanged then.
Result<PoseCount> setClockOffset(Project& project, TrajectoryId trajectory, double offsetSecs,
                                 std::optional<double> stdSecs = {});

/// The trajectory of that name, or the only one where `name` is empty.
Result<TrajectoryId> trajectoryByName(const Project& project, const std::string& name);

/// How the frame's rows were read: its camera's read-out time, and the velocity that its trajectory has there, or that
/// the poses of the frames before and after it imply (at most a second apart). Off where either is unknown.
RollingShutter shutterOf(const Project& project, const Frame& frame);

}  // namespace alidade
