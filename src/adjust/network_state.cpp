// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/network_state.h"

#include <algorithm>

namespace alidade {

namespace {

glm::dvec3 originOf(const Network& network) {
  std::vector<glm::dvec3> places;
  for (const NetworkPose& pose : network.poses)
    if (pose.bodyFromWorld) places.push_back(pose.bodyFromWorld->centre());
  for (const NetworkPoint& point : network.points)
    if (point.world) places.push_back(*point.world);
  if (places.empty()) return glm::dvec3(0);
  // The median of each axis, whole metres: one far slip does not move it.
  glm::dvec3 origin;
  for (int i = 0; i < 3; ++i) {
    const auto middle = places.begin() + static_cast<std::ptrdiff_t>(places.size() / 2);
    std::nth_element(places.begin(), middle, places.end(), [i](const auto& a, const auto& b) { return a[i] < b[i]; });
    origin[i] = std::round((*middle)[i]);
  }
  return origin;
}

std::vector<bool> lockedOf(const NetworkCamera& camera) {
  const VaryingCamera varying(camera.intrinsics);
  std::vector<bool> locked(varying.parameterCount(), !camera.freeDistortion);
  for (int i = 0; i < varying.focalCount(); ++i) locked[i] = !camera.freeFocal;
  for (int i = 0; i < 2; ++i) locked[varying.focalCount() + i] = !camera.freePrincipalPoint;
  for (std::size_t i = 0; i < camera.held.size(); ++i) locked[i] = locked[i] || camera.held[i];
  return locked;
}

}  // namespace

PoseState stateOf(const RigidTransform& bodyFromWorld, const glm::dvec3& origin) {
  return {bodyFromWorld.centre() - origin, glm::normalize(bodyFromWorld.rotation)};
}

RigidTransform transformOf(const PoseState& state, const glm::dvec3& origin) {
  return {state.rotation, -(state.rotation * (origin + state.centre))};
}

NetworkLayout::NetworkLayout(const Network& network) : origin(originOf(network)) {
  const auto add = [&](std::vector<bool> locked) {
    const auto free = std::count(locked.begin(), locked.end(), false);
    if (free == 0) return -1;
    freeUnknowns += static_cast<int>(free);
    ParameterBlock block{unknowns, static_cast<int>(locked.size()), std::move(locked)};
    unknowns += block.size;
    blocks.push_back(std::move(block));
    return static_cast<int>(blocks.size()) - 1;
  };
  for (const NetworkPose& pose : network.poses) poseBlock.push_back(add(std::vector<bool>(pose.locked.begin(), pose.locked.end())));
  for (const NetworkMount& mount : network.mounts) mountBlock.push_back(add(std::vector<bool>(mount.locked.begin(), mount.locked.end())));
  for (const NetworkCamera& camera : network.cameras) cameraBlock.push_back(add(lockedOf(camera)));
  for (const NetworkTrajectory& trajectory : network.trajectories) clockBlock.push_back(add({!trajectory.clockFree}));
  for (std::size_t i = 0; i < network.points.size(); ++i) {
    const NetworkPoint& point = network.points[i];
    const bool exact = point.kind != PointKind::Tie && point.sigmaM == glm::dvec3(0);
    pointSlot.push_back(exact ? -1 : static_cast<int>(slotPoint.size()));
    if (!exact) slotPoint.push_back(static_cast<int>(i));
  }
}

NetworkState NetworkLayout::moved(const NetworkState& state, const double* blockStep,
                                  const std::vector<glm::dvec3>& pointStep) const {
  NetworkState to = state;
  const auto stepOf = [&](int block) { return blockStep + blocks[block].offset; };
  for (std::size_t i = 0; i < poseBlock.size(); ++i)
    if (poseBlock[i] >= 0) to.poses[i] = alidade::moved(state.poses[i], stepOf(poseBlock[i]));
  for (std::size_t i = 0; i < mountBlock.size(); ++i) {
    if (mountBlock[i] < 0) continue;
    const double* s = stepOf(mountBlock[i]);
    to.mounts[i].translation += glm::dvec3(s[0], s[1], s[2]);
    to.mounts[i].rotation = glm::normalize(quaternionOf({s[3], s[4], s[5]}) * state.mounts[i].rotation);
  }
  for (std::size_t i = 0; i < cameraBlock.size(); ++i)
    if (cameraBlock[i] >= 0) to.cameras[i] = state.cameras[i].moved(stepOf(cameraBlock[i]));
  for (std::size_t i = 0; i < clockBlock.size(); ++i)
    if (clockBlock[i] >= 0) to.clocks[i] += *stepOf(clockBlock[i]);
  for (std::size_t slot = 0; slot < slotPoint.size(); ++slot) to.points[slotPoint[slot]] += pointStep[slot];
  return to;
}

}  // namespace alidade
