// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "adjust/calibration.h"
#include "base/error.h"
#include "base/progress.h"
#include "survey/project.h"
#include "targets/board.h"

namespace alidade {

struct CalibrationJob {
  std::vector<std::string> pictures;  ///< files, or folders of pictures
  Board board;
  CalibrationOptions options;
};

struct CalibrationOutcome {
  Board board;
  int width = 0, height = 0;           ///< of the pictures
  std::vector<BoardPicture> found;     ///< pictures that show the board
  std::vector<std::string> leftOut;    ///< the others, each with its reason
  CalibrationSummary summary;
};

/// Finds the board in every picture (on all cores) and calibrates. A picture that cannot be read, shows no board or
/// has another size than most is left out and listed. Error where there is no picture, or none shows the board; a set
/// that does not fix the camera is an outcome whose summary did not converge.
Result<CalibrationOutcome> calibrate(const CalibrationJob& job, const Progress& progress);

/// Gives a calibration to the project's cameras of that name (all frames that they took show through it from now on),
/// or adds a camera. Error where a camera of that name takes pictures of another size.
Result<void> keepCalibration(Project& project, const Intrinsics& intrinsics, const std::string& camera);

}  // namespace alidade
