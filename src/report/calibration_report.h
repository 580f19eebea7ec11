// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "adjust/calibration.h"
#include "base/error.h"

namespace alidade {

struct CalibrationReport {
  std::string title;                 ///< what was calibrated
  std::string software;              ///< "Alidade 0.1.0"
  std::string board;                 ///< "chessboard:8x6:0.025"
  std::vector<std::string> leftOut;  ///< pictures that took no part, each with its reason
  CalibrationSummary summary;
};

/// One page with the figures, the residuals in the picture and along the radius, and the coverage: PDF (*.pdf), a web
/// page that stands alone (*.html) or a picture (*.png). Error for another ending, or where it cannot be written; the
/// file appears whole or not at all. Needs a QGuiApplication.
Result<void> writeCalibrationReport(const CalibrationReport& report, const std::string& path);

}  // namespace alidade
