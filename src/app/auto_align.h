// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "align/auto_align.h"
#include "app/workspace.h"
#include "base/error.h"
#include "base/progress.h"
#include "survey/project.h"

namespace alidade {

/// What pictures are aligned with: the surfaces that were scanned, or those that are designed.
enum class AlignTo { Scans, Designs };

/// Scans where one is visible, else designs.
AlignTo alignmentTarget(const Project& project);

/// The visible scans, or the visible elements of the visible designs, of a project as a scene to align pictures with.
AlignmentScene alignmentScene(const Project& project, const LoadedData& data, AlignTo to);

/// Aligns a frame with the scene from the pose that it has. The project gets the new pose, with its quality, where it
/// converged and not `dryRun`; else it is unchanged. Error, with what to do, for a frame without pose, camera or
/// picture and for what alignPicture() refuses.
Result<AlignmentSummary> autoAlignFrame(Project& project, const AlignmentScene& scene, PictureCache& pictures, FrameId frame,
                                        const AlignmentOptions& options, bool dryRun, const Progress& progress);

}  // namespace alidade
