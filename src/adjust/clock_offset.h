// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/progress.h"
#include "camera/camera.h"
#include "survey/trajectory.h"

namespace alidade {

/// Places in two pictures that show the same thing: pixels, OpenCV's origin.
struct TrackedPair {
  double firstSecs = 0, secondSecs = 0;  ///< on the pictures' clock
  std::vector<std::pair<glm::dvec2, glm::dvec2>> tracks;
};

struct ClockOffsetOptions {
  double startSecs = 0;    ///< middle of the range that is searched
  double rangeSecs = 1.0;  ///< to either side
  double stepSecs = 0.01;  ///< of the search; what the camera does must be smooth over it
  double nearestM = 0.3;   ///< nothing in the pictures is nearer, depth in metres
  double readoutSecs = 0;  ///< of the rolling shutter, see camera/rolling_shutter.h
  double scalePx = 1.0;    ///< of the robust loss (Cauchy)
  double worstStdSecs = 0.02;  ///< beyond it the offset counts as unknown
  Result<void> validate() const;
};

/// Pose clock minus picture clock, as Trajectory::clockOffsetSecs.
struct ClockOffset {
  bool found = false;
  std::string reason;      ///< where it was not found: why, and what to do
  double offsetSecs = 0;
  double stdSecs = 0;      ///< one sigma, from the scatter between pairs and between regions of the picture
  double rmsPx = 0;        ///< of the tracks that fit, from their epipolar segments
  double fitting = 0;      ///< share of the tracks within three pixels
  int pairs = 0, tracks = 0;
  std::string report() const;
};

/// Finds the offset at which the trajectory's relative poses explain how the pictures moved. A place seen at x in the
/// first picture must be seen in the second on the segment that its ray draws there, from infinity to `nearestM`; the
/// distance from it is what is minimised, robustly, over the one unknown. That uses rotation and translation alike, and needs no
/// depth; for a camera that only turns the segment is a point.
///
/// A search over the range comes first, Gauss-Newton from its best. The standard deviation is the
/// sandwich estimator (Liang and Zeger 1986), clustered both ways (Cameron, Gelbach and Miller 2011): by pair, because the tracks of
/// a pair share their poses' errors, with pairs near in time alike (Newey and West 1987); and by region of the picture, because tracks slide
/// along the same edges from pair to pair. A few seconds hold few clusters, and of few it comes out small: on pieces of the sample video of 2 s the
/// errors' root mean square was 1.4 times the one stated, of 3 s 1.1 times, of 6 s 0.65 times. Give it five seconds or more.
///
/// Not found, with the reason: too few tracks; a camera that stands still or moves evenly, whose relative poses do not
/// depend on the offset; another place in the range that explains the pictures as well; the best at the end of
/// the range; poses that explain them nowhere. Error for options that make no sense.
Result<ClockOffset> estimateClockOffset(const std::vector<TrackedPair>& pairs, const Camera& camera, const PoseTrack& track,
                                        const ClockOffsetOptions& options, const Progress& progress);

}  // namespace alidade
