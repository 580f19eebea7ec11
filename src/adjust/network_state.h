// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "adjust/lens_derivatives.h"
#include "adjust/network.h"
#include "adjust/pose_state.h"

namespace alidade {

/// Camera from body: p = rotation · pInBody + translation.
struct MountState {
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 translation{0};
};

/// All unknowns at one moment of the adjustment, world coordinates relative to the layout's origin.
struct NetworkState {
  std::vector<PoseState> poses;
  std::vector<MountState> mounts;
  std::vector<VaryingCamera> cameras;
  std::vector<double> clocks;
  std::vector<glm::dvec3> points;
};

/// A run of unknowns that belong together: a pose, a mount, a calibration, a clock.
struct ParameterBlock {
  int offset = 0, size = 0;
  std::vector<bool> locked;
};

/// Which unknowns there are. Blocks count over poses, mounts, cameras and clocks in this order, those with nothing
/// free left out; points are numbered apart, known exact ones left out.
struct NetworkLayout {
  explicit NetworkLayout(const Network& network);

  glm::dvec3 origin{0};  ///< near the poses and points
  std::vector<ParameterBlock> blocks;
  int unknowns = 0;      ///< of all blocks, locked ones included
  int freeUnknowns = 0;
  std::vector<int> poseBlock, mountBlock, cameraBlock, clockBlock;  ///< -1: locked
  std::vector<int> pointSlot;  ///< -1: known exactly
  std::vector<int> slotPoint;

  NetworkState moved(const NetworkState& state, const double* blockStep, const std::vector<glm::dvec3>& pointStep) const;
};

/// A pose relative to an origin, and back.
PoseState stateOf(const RigidTransform& bodyFromWorld, const glm::dvec3& origin);
RigidTransform transformOf(const PoseState& state, const glm::dvec3& origin);

}  // namespace alidade
