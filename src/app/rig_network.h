// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <vector>

#include "adjust/network.h"
#include "base/error.h"
#include "survey/project.h"

namespace alidade {

/// What ties a network's frames to each other beyond what is seen in them.
struct MotionTies {
  bool rig = false;          ///< cameras with pictures of the same moments sit on one body
  bool freeMounts = false;   ///< where they sit on it is adjusted, too
  bool trajectory = false;   ///< poses are held to the trajectories that serve their frames
  bool freeClock = false;    ///< the offset between the pictures' clock and the trajectory's is adjusted, too

  bool any() const { return rig || freeMounts || trajectory || freeClock; }
};

/// The trajectories that share a network's clock offset, one list a NetworkTrajectory.
using NetworkClocks = std::vector<std::vector<TrajectoryId>>;

/// Puts frames of one moment (to a millisecond) on one body: that of the first frame's camera, whose frames keep their
/// poses; every other camera gets a mount: as the project keeps them (`kept`, one a network camera), where both sit on the
/// same body, else the mean of what the poses say. Expects a pose a frame and nothing but
/// priors that refers to poses; poses without a frame are gone afterwards. Error where two cameras have no moment in
/// common, or where a mounted frame has a prior.
Result<void> joinRig(Network& network, const std::vector<std::optional<CameraMount>>& kept, bool freeMounts);

/// Holds the poses of the bodies to the trajectories of their frames, as well as those are believed to be known
/// (NetworkTrajectory). `frames`: of the project, one a NetworkFrame. Error where no frame has a trajectory.
Result<NetworkClocks> holdToTrajectories(const Project& project, const std::vector<FrameId>& frames, bool freeClock, Network& network);

/// Both, where `ties` wants them.
Result<NetworkClocks> tieMotion(const Project& project, const std::vector<FrameId>& frames, const MotionTies& ties, Network& network);

/// Gives the project's trajectories the adjusted clock offsets (frames that were not refined follow), and its cameras the
/// mounts that were free. `frames` as above.
void applyMotion(Project& project, const std::vector<FrameId>& frames, const Network& network, const NetworkClocks& clocks,
                 const NetworkSummary& summary);

}  // namespace alidade
