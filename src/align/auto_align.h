// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <string>
#include <vector>

#include "align/pose_estimate.h"
#include "align/pose_search.h"
#include "align/scan_view.h"
#include "base/error.h"
#include "base/progress.h"
#include "camera/rolling_shutter.h"

namespace alidade {

struct AlignmentOptions {
  SearchRange range;
  std::array<bool, 3> lockPosition{false, false, false};  ///< E, N, H of the camera's centre
  bool lockAttitude = false;
  RollingShutter shutter = {};  ///< the rows' poses keep their places beside the frame's, that of the middle row, which is sought
  bool startIsNear = false;  ///< within some 5 pixels of a picture 480 wide: the range is not searched
  double acceptedPx = 1.0;  ///< of the raw picture, or of 1920 across where it is wider: what converged means

  Result<void> validate() const;
};

/// What speaks for and against a pose. Pixels are those of AlignmentOptions::acceptedPx.
struct AlignmentEvidence {
  int patches = 0;             ///< of the drawn scene that could have been found in the picture
  int matched = 0;             ///< found
  int inliers = 0;             ///< agree with the pose
  double correlation = 0;      ///< median of the inliers
  double spread = 0;           ///< share of a 4 × 4 grid over the scene in view that holds inliers
  double expectedPx = 0;       ///< 95 % error of the overlay: the pose's covariance, and what single places are off
  double halvesPx = 0;         ///< distance between the poses from the white and the black blocks of the picture
  double information = 0;      ///< normalised information distance to the picture, 0 the same, 1 unrelated
  double informationAside = 0; ///< the same with the picture moved a little: the least over eight directions
  double rivalScore = 0;       ///< of the best other pose in the search, against the best: 1 as good
  double asideScore = 0;       ///< of edges: of the best pose a few pixels aside, against the found one
};

struct AlignmentSummary {
  bool converged = false;
  std::string reason;              ///< why it ended, or why it is not believed
  double confidence = 0;           ///< 0..1; the weakest of what was checked
  RigidTransform cameraFromWorld;  ///< the start where not converged
  RigidTransform startCameraFromWorld;
  AlignmentEvidence evidence;
  PoseEstimate estimate;           ///< of the finest level, in its pixels; also where it is not believed
  std::vector<SeenPlace> places;   ///< what the pose stands on, pixels of the raw picture
  double levelScale = 1;           ///< raw pixels a pixel of the finest level

  std::string report() const;
};

/// Aligns a picture with the scene from a pose up to AlignmentOptions::range off.
///
/// The scene is drawn as the pose sees it and patches of it are looked for in the picture: at a small size over the
/// whole range by searchPoses(), from several centres where the range moves near things far across the picture; then
/// from size to size by resection of what was found, drawn anew at each pose, up to where the scan's points lie a
/// pixel apart. The result counts as converged only where all of AlignmentEvidence speaks for it.
///
/// A scene without colours and intensities is fitted by its edges instead, steps and folds of its surfaces against those
/// of the photo: coarsely as above, at last by fitEdges().
///
/// Error for what cannot be tried: a picture of another size than the calibration, too dark or without contrast, no
/// scene in view. Cancels between steps.
Result<AlignmentSummary> alignPicture(const AlignmentScene& scene, const ColourImage& photo, const Camera& camera,
                                      const RigidTransform& startCameraFromWorld, const AlignmentOptions& options = {},
                                      const Progress& progress = {});

}  // namespace alidade
