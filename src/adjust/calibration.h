// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/progress.h"
#include "camera/camera.h"
#include "geometry/rigid_transform.h"
#include "targets/board.h"

namespace alidade {

// Calibrating a camera from pictures of a flat board. Metres, radians, pixels in OpenCV's origin.

/// What was found of the board in one picture.
struct BoardPicture {
  std::string name;
  std::vector<BoardCorner> corners;
};

struct CalibrationOptions {
  CameraModel model = CameraModel::OpenCv5;
  bool robust = true;      ///< corners that do not fit take no part; false: plain least squares over all, as OpenCV
  double boardSigmaM = 0;  ///< > 0: the board's corners are adjusted, too, held to their nominal places by this
  int parts = 5;           ///< the held-out check leaves out each of so many parts of the pictures in turn; 0: no check

  Result<void> validate() const;
};

struct CalibrationResidual {
  int picture = -1, corner = -1;
  glm::dvec2 pixel{0};       ///< measured
  glm::dvec2 residualPx{0};  ///< projected - measured
  bool outlier = false;      ///< took no part
};

struct CalibratedPicture {
  std::string name;
  RigidTransform cameraFromBoard;
  double rmsPx = 0;                     ///< root of the mean squared distance of its corners
  int corners = 0, outliers = 0;
  double tiltRad = 0;                   ///< between the board's normal and the optical axis
  std::optional<double> heldOutRmsPx;   ///< with a calibration made without this picture
};

/// The board against a flat one of the nominal size, where it was adjusted.
struct BoardShape {
  double offPlaneM = 0, inPlaneM = 0;  ///< root mean squares
  double worstM = 0;
  int worstCorner = 0;
};

struct CalibrationSummary {
  bool converged = false;
  std::string reason;                  ///< why it ended, or why it was refused and what to do
  Intrinsics intrinsics;
  std::vector<double> parameterStd;    ///< of intrinsics.parameters(), from the residuals' own size
  std::vector<double> correlation;     ///< between them, row by row
  double rmsPx = 0;                    ///< root of the mean squared distance over the corners that took part
  double sigmaPx = 0;                  ///< a posteriori standard deviation of one pixel coordinate
  int iterations = 0, redundancy = 0, outliers = 0;
  std::vector<CalibratedPicture> pictures;     ///< those that took part
  std::vector<CalibrationResidual> residuals;  ///< picture: index into `pictures`
  std::optional<double> heldOutRmsPx;          ///< over all pictures, each with a calibration made without it
  std::optional<BoardShape> board;
  double coverage = 0;                 ///< share of 8 × 6 cells of the picture that hold a corner
  std::vector<std::string> correlations;  ///< pairs that can hardly be told apart, as sentences
  std::vector<std::string> warnings;

  std::string report() const;          ///< a page of text
};

/// Adjusts a camera and the board's pose in each picture by least squares over all corners (adjustNetwork; analytic
/// derivatives). It starts from homographies: the focal length in closed form (Zhang, A flexible new technique for
/// camera calibration, 2000, with the principal point in the middle) or from a ladder of focal lengths where the lens
/// is too wide for that, the poses from the homographies' columns.
///
/// Refused, converged false, where the pictures do not fix the camera: fewer than three, the board parallel to the
/// image or at the same attitude in all of them, never out of the middle, or a model with more parameters than they
/// carry. Error for input that makes no sense.
Result<CalibrationSummary> calibrateCamera(const Board& board, int width, int height,
                                           const std::vector<BoardPicture>& pictures,
                                           const CalibrationOptions& options = {}, const Progress& progress = {});

}  // namespace alidade
