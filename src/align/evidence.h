// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "align/auto_align.h"
#include "align/fine_fit.h"

namespace alidade {

/// What the options say of the start: as good as the range, one standard deviation half of it.
PoseKnowledge knowledgeOf(const RigidTransform& start, const AlignmentOptions& options);

/// Gathers the evidence for the pose that the finest level gave and decides whether it is believed: fills all of the
/// summary but the start and the rival.
void judge(const FineFit& fit, const PictureLevel& level, const AlignmentOptions& options, AlignmentSummary& summary);

/// Normalised information distance (H(A|B) + H(B|A)) / H(A,B) between the drawn scene and the photo moved by `shift`
/// pixels, over the covered pixels, from a 32 × 32 histogram. Li et al. (2004), The similarity metric; used for lidar
/// against pictures by Pandey et al. (2015).
double informationDistance(const ScanView& view, const Image<float>& photo, const glm::ivec2& shift);

}  // namespace alidade
