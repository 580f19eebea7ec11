// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <vector>

#include "align/anchors.h"
#include "align/picture_levels.h"
#include "align/pose_estimate.h"

namespace alidade {

/// The last fit of a picture, from a pose a few pixels off at most: every patch that is found counts by what it knows,
/// one on a straight edge across it.
struct FineFit {
  RigidTransform drawnAt;       ///< the pose that the view and the anchors were drawn from
  ScanView view;
  Image<float> photo;           ///< blurred like the view
  double blurPx = 0;
  std::vector<Anchor> anchors;
  std::vector<int> anchorOf;    ///< of each place
  std::vector<SeenPlace> places;
  std::vector<double> correlation;  ///< of each place
  std::optional<PoseEstimate> estimate;
  double movedPx = 0;           ///< mean over the anchors
  double score = 0;             ///< of edges: mean strength of the photo's edges at those drawn, above chance
  double asideScore = 0;        ///< of the best pose a few pixels aside, against this one's
};

struct FineFitOptions {
  int half = 10;
  int radiusPx = 4;
  double leastCorrelation = 0.5;
  double blurPx = -1;  ///< of the photo; below 0: the one that finds most
  PoseKnowledge known;
};

/// Blocks of the picture that share what is wrong with them: a grid of kBlockColumns by kBlockRows.
constexpr int kBlockColumns = 6, kBlockRows = 4;

/// The block of a pixel.
int blockOf(const glm::dvec2& at, const Image<float>& photo);

FineFit fineFit(const AlignmentScene& scene, const PictureLevel& level, const RigidTransform& cameraFromWorld,
                const FineFitOptions& options);

}  // namespace alidade
