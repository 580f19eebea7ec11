// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "adjust/calibration.h"

namespace alidade {

/// The homography that takes the plane points to the image points: direct linear transform with Hartley's
/// normalisation. Four points or more; nothing where they do not fix it.
std::optional<Eigen::Matrix3d> homographyOf(const std::vector<glm::dvec2>& plane, const std::vector<glm::dvec2>& image);

/// The pose of a plane z = 0 whose points a homography takes to the image plane z = 1 of a camera; the plane's point
/// `inFront` lies in front of it.
std::optional<RigidTransform> poseOfHomography(const Eigen::Matrix3d& imageFromPlane, const glm::dvec2& inFront);

/// Zhang's two equations a picture for square pixels and a known principal point: (h1ᵀ w h2 = 0, h1ᵀ w h1 = h2ᵀ w h2);
/// the homographies' pixels count from the principal point. Nothing where they are open or contradict each other.
std::optional<double> focalOfHomographies(const std::vector<Eigen::Matrix3d>& pixelFromPlane);

/// Approximate camera (one focal length, the principal point in the middle, no distortion beyond a fisheye's own) and
/// the board's pose in each picture, nothing for a picture whose corners fix none.
struct CalibrationStart {
  double focalPx = 0;
  std::vector<std::optional<RigidTransform>> cameraFromBoard;
};
std::optional<CalibrationStart> calibrationStart(const std::vector<glm::dvec3>& board, int width, int height,
                                                 const std::vector<BoardPicture>& pictures, bool fisheye);

}  // namespace alidade
