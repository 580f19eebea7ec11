// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adjust/network.h"
#include "app/observation_rows.h"
#include "app/rig_network.h"
#include "survey/project.h"

namespace alidade {

/// What may move of every frame and camera that is refined.
struct NetworkFreedom {
  std::array<bool, 3> lockPosition{};  ///< E N H of the camera's centre
  std::array<bool, 3> lockAttitude{};  ///< rotation about the camera's x y z
  bool focal = false, principalPoint = false, distortion = false;
  MotionTies ties;
};

/// The frames that a network refines, and the network itself.
struct NetworkRefinement {
  std::vector<FrameId> frames;      ///< one a NetworkFrame
  std::vector<CameraId> cameras;    ///< one a NetworkCamera
  Network network;
  NetworkClocks clocks;
  std::vector<std::size_t> observationRows, edgeRows, depthRows;  ///< the row behind each of the network's lists
  std::map<int, std::size_t> surfaceRows;                         ///< that of a point's surface

  /// The row that a residual belongs to; nothing for priors and what else no row said.
  std::optional<std::size_t> rowOf(const NetworkResidual& residual) const;
};

/// Rows as a network over the project's frames; rows that name no frame belong to `frame`. Errors name the row: a frame
/// that does not exist or has no camera, a point observed twice in a frame, two coordinates for one name, a picture whose
/// size is not its calibration's.
Result<NetworkRefinement> networkOf(const Project& project, const std::string& frame,
                                    const std::vector<ObservationRow>& rows, const NetworkFreedom& freedom);

/// The enabled observations that a project keeps, as rows: all, or those of one frame without the points of unknown place,
/// which one picture cannot have. Depths and surfaces of points that none of them shows are left out.
std::vector<ObservationRow> observationRowsOf(const Project& project, FrameId only = {});

/// The project keeps the rows as its own observations, in place of those of the same frame, kind and name; rows that name no
/// frame belong to `frame`. Error for a camera's position, which is no observation, and for a frame that does not exist;
/// the project is unchanged then.
Result<void> keepObservations(Project& project, const std::string& frame, const std::vector<ObservationRow>& rows);

/// Adjusts, and gives the project the new poses (and calibrations that were free) where it converged and not `dryRun`.
Result<NetworkSummary> refineNetwork(Project& project, const NetworkRefinement& refinement, const NetworkOptions& options,
                                     bool dryRun, const Progress& progress);

}  // namespace alidade
