// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adjust/calibration.h"
#include "adjust/network.h"

namespace alidade {

/// Sizes, indices and numbers that make no sense.
Result<void> checkBoardPictures(const Board& board, int width, int height, const std::vector<BoardPicture>& pictures);

/// Fewer than six corners, or all on one line, fix no pose.
bool carriesPose(const Board& board, const BoardPicture& picture);

/// A sentence where the corners lie in the middle of the picture only.
std::optional<std::string> refusalOfCoverage(int width, int height, const std::vector<BoardPicture>& pictures);

/// A sentence where the board's attitudes cannot fix the focal length: parallel to the image, or all the same, within
/// an angle. Homographies through a bent lens give attitudes to a few degrees only, the adjustment far better.
constexpr double alikeAtStartRad = 0.02, alikeRad = 0.07;
std::optional<std::string> refusalOfAttitudes(const std::vector<RigidTransform>& cameraFromBoard, double withinRad);

/// A sentence where focal length or principal point are known too badly to be of use.
std::optional<std::string> refusalOfAccuracy(const CalibrationSummary& summary);

/// Angle between the board's normal and the optical axis, 0..π/2.
double boardTilt(const RigidTransform& cameraFromBoard);

/// Fills coverage, correlations and what the user should know of a calibration that did converge.
void judgeCalibration(const CameraAccuracy& accuracy, CalibrationSummary& summary);

}  // namespace alidade
