// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "survey/project.h"

namespace alidade {

/// A row of a table of times.
struct FrameTime {
  std::string name;  ///< of the picture; empty where the table has times alone, one a frame in order
  double secs = 0;
  std::string where;  ///< file and line
};

/// A table of times: `time`, `name,time` or `time,name` a line, commas or blanks between; a header or comment (#) may
/// stand first. Whole numbers of more than 14 digits are nanoseconds (EuRoC's data.csv). Errors name the line.
Result<std::vector<FrameTime>> readFrameTimes(const std::string& path);

/// Gives the frames of a video, or all frames that are of none, their times and lays them on their trajectories
/// anew. By name where the table has names, else one a frame in order. Error, and the project unchanged, where the counts differ,
/// a frame is missing, or times do not rise from frame to frame.
Result<void> setFrameTimes(Project& project, VideoId video, const std::vector<FrameTime>& times);

/// The same at a constant rate, from `startSecs`.
Result<void> setFrameRate(Project& project, VideoId video, double framesPerSecond, double startSecs);

/// The first frame of a video, or else of none, whose time does not lie after the one before; -1 where all rise.
std::ptrdiff_t firstFallingTime(const Project& project, VideoId video);

}  // namespace alidade
