// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "adjust/network.h"
#include "app/auto_align.h"
#include "app/rig_network.h"

namespace alidade {

struct SequenceOptions {
  AlignmentOptions alignment;
  int everyNth = 1;            ///< frames between keyframes; those between two get their motion
  int placesAFrame = 80;       ///< of the scene, kept for the adjustment
  int tiesAPair = 40;          ///< natural points followed from keyframe to keyframe, held to the scene's surface
  double heldOutShare = 0.1;   ///< of the places: they take no part and check the result
  MotionTies ties;             ///< cameras on one rig, poses held to trajectories
  std::vector<glm::dvec3> at;    ///< object points where each frame's expected error is wanted
  double metresPerSecond2 = 3, radiansPerSecond2 = 3;  ///< how smoothly a camera moves; see NetworkSmoothness

  Result<void> validate() const;
};

/// What became of a keyframe.
struct SequenceFrame {
  FrameId frame;
  RigidTransform before, after;  ///< camera from world; the same where it could not be refined
  bool aligned = false;          ///< found itself in the scene; else it hangs on its neighbours or was left out
  bool refined = false;
  std::string reason;            ///< why not
  double expectedPx = 0;         ///< of the alignment, 95 %
};

/// A camera that stood still by its poses no longer stands where it did.
struct MovementAlarm {
  FrameId frame;         ///< the first that shows it
  double metres = 0, radians = 0;
  double pixels = 0;     ///< mean over the scene in view
};

struct SequenceSummary {
  bool converged = false;
  std::string reason;
  std::vector<SequenceFrame> frames;
  std::vector<int> seenAs;       ///< of each frame, index into the network's frames; -1: left out
  Network network;
  NetworkClocks clocks;
  NetworkSummary adjustment;     ///< sigma naught, each pose's standard deviations, held-out places
  std::vector<MovementAlarm> alarms;

  /// Of a refined frame; that of its body, where its camera sits on a rig.
  const AdjustedPose& poseOf(std::size_t frame) const { return adjustment.poses[network.frames[seenAs[frame]].pose]; }
  /// Of a refined frame, one for each of SequenceOptions::at.
  std::vector<ExpectedError> expectedIn(std::size_t frame) const;
  std::string report(const Project& project) const;
};

/// Refines all frames with a pose together. Each keyframe is aligned with the scene, scan or design, from where the one before says it
/// should be, so that a drift of any size is followed; then the places of the scene that were found, natural points followed
/// from keyframe to keyframe and held to the scene's surface, and the smoothness of the motion are adjusted at once. Frames
/// of one camera whose poses are all the same stand still: no smoothness, and an alarm where one moved.
///
/// The project gets the new poses, with their quality, where the adjustment converged and not `dryRun`; else, and
/// when cancelled, it is unchanged.
Result<SequenceSummary> refineSequence(Project& project, const AlignmentScene& scene, PictureCache& pictures,
                                       const SequenceOptions& options, bool dryRun, const Progress& progress);

}  // namespace alidade
