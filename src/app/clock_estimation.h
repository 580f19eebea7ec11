// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "adjust/clock_offset.h"
#include "app/workspace.h"
#include "base/error.h"
#include "base/progress.h"
#include "survey/project.h"

namespace alidade {

struct ClockEstimationOptions {
  ClockOffsetOptions search;  ///< startSecs is set to the trajectory's present offset
  int atMostPairs = 60;
};

/// Estimates how the trajectory's clock stands to that of the frames it serves, from what moved in the pictures (see
/// adjust/clock_offset.h): follows corners from frame to frame in pairs spread over the video, each as far apart as the
/// picture needs to move visibly. The project is not changed.
Result<ClockOffset> estimateClock(const Project& project, TrajectoryId trajectory, const ClockEstimationOptions& options,
                                  PictureCache& pictures, const Progress& progress);

}  // namespace alidade
