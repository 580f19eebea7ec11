// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "adjust/resection.h"
#include "align/anchors.h"
#include "align/picture_levels.h"

namespace alidade {

/// One size of the picture against the scene drawn from one pose.
struct LevelFit {
  ScanView view;                    ///< from the pose before the fit
  std::vector<Anchor> anchors;
  std::vector<int> anchorOf;        ///< of each observation
  std::vector<double> correlation;  ///< of each observation
  std::vector<ResectionObservation> observations;  ///< pixels of the level
  ResectionSummary resection;
  double movedPx = 0;               ///< mean over the anchors, by this fit

  int inliers() const { return static_cast<int>(observations.size()) - resection.outlierCount(); }
  /// Share of the anchors that were found and agree, times how well they correlate.
  double score() const;
};

struct LevelFitOptions {
  int half = 7, cellPx = 12, radiusPx = 4;
  double leastCorrelation = 0.6;
  double noisePx = 0.15;  ///< of every match, beside its own
  ResectionOptions resection;
};

LevelFit fitLevel(const AlignmentScene& scene, const PictureLevel& level, const RigidTransform& cameraFromWorld,
                  const LevelFitOptions& options);

}  // namespace alidade
