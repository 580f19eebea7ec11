// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/auto_align.h"
#include "app/rig_network.h"
#include "cli/command.h"

namespace alidade::cli {

struct RefinePictures {
  std::string project, frame;  ///< no frame: all that have a pose
  AlignmentOptions options;
  int keyframes = 1;  ///< of a sequence: every so many frames
  bool dryRun = false;
  std::optional<AlignTo> to = {};  ///< none: alignmentTarget()
  MotionTies ties = {};            ///< of a sequence
  std::vector<glm::dvec3> at = {}; ///< where the expected error is wanted
};

/// "mounts" and "clocks" of an adjustment.
void addMotion(const Project& project, const Network& network, const NetworkClocks& clocks, const NetworkSummary& summary,
               nlohmann::ordered_json& json);

/// `refine --auto`: each frame by itself against the scans or the designs.
Result<Answer> refineAutomatically(const RefinePictures& wanted, const Progress& progress);

/// `refine --sequence`: all frames together, with tie points and smoothness.
Result<Answer> refineTogether(const RefinePictures& wanted, const Progress& progress);

}  // namespace alidade::cli
