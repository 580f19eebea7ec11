// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/rig_network.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <optional>

#include "app/camera_mount.h"
#include "app/pose_clock.h"

namespace alidade {

namespace {

constexpr double kSameMomentSecs = 1e-3;

/// Frames by the moment they were taken at.
std::vector<std::vector<int>> momentsOf(const Network& network) {
  std::vector<int> order(network.frames.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  const auto timeOf = [&](int frame) { return network.poses[network.frames[frame].pose].timeSecs; };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return timeOf(a) < timeOf(b); });
  std::vector<std::vector<int>> moments;
  for (const int frame : order) {
    const bool same = !moments.empty() && timeOf(frame) - timeOf(moments.back().front()) <= kSameMomentSecs;
    // Two pictures of one camera are two moments, however near.
    const bool repeated = same && std::any_of(moments.back().begin(), moments.back().end(), [&](int other) {
      return network.frames[other].camera == network.frames[frame].camera;
    });
    if (!same || repeated) moments.emplace_back();
    moments.back().push_back(frame);
  }
  return moments;
}

/// The mean over the moments that show both cameras; poses differ so little that quaternions are averaged as they are.
std::optional<RigidTransform> mountOf(const Network& network, const std::vector<std::vector<int>>& moments, int camera, int base) {
  glm::dquat rotation(0, 0, 0, 0);
  glm::dvec3 translation(0);
  double count = 0;
  for (const std::vector<int>& moment : moments) {
    const RigidTransform *on = nullptr, *body = nullptr;
    for (const int frame : moment) {
      const auto& pose = network.poses[network.frames[frame].pose].bodyFromWorld;
      if (!pose) continue;
      if (network.frames[frame].camera == camera) on = &*pose;
      if (network.frames[frame].camera == base) body = &*pose;
    }
    if (!on || !body) continue;
    const RigidTransform mount = *on * body->inverse();
    rotation = rotation + (glm::dot(rotation, mount.rotation) < 0 ? -mount.rotation : mount.rotation);
    translation += mount.translation;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return RigidTransform{glm::normalize(rotation), translation / count};
}

/// Bodies without a frame are left out, and those that stay counted anew.
void dropEmptyPoses(Network& network) {
  std::vector<int> number(network.poses.size(), -1);
  for (const NetworkFrame& frame : network.frames) number[frame.pose] = 0;
  std::vector<NetworkPose> kept;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(kept.size());
    kept.push_back(std::move(network.poses[i]));
  }
  network.poses = std::move(kept);
  for (NetworkFrame& frame : network.frames) frame.pose = number[frame.pose];
  for (PosePrior& prior : network.priors) prior.pose = number[prior.pose];
}

/// Of each network camera.
std::vector<std::optional<CameraMount>> mountsOf(const Project& project, const std::vector<FrameId>& frames, const Network& network) {
  std::vector<std::optional<CameraMount>> kept(network.cameras.size());
  for (std::size_t i = 0; i < frames.size(); ++i)
    kept[network.frames[i].camera] = project.findCamera(project.findFrame(frames[i])->camera)->mount;
  return kept;
}

/// On the body that the carrying camera itself is known to sit on, else on that camera.
void applyMounts(Project& project, const std::vector<FrameId>& frames, const Network& network, const NetworkSummary& summary) {
  CameraRecord* carrier = nullptr;
  for (std::size_t i = 0; i < frames.size() && !carrier; ++i)
    if (network.frames[i].mount < 0) carrier = project.findCamera(project.findFrame(frames[i])->camera);
  if (!carrier) return;
  if (!carrier->mount) carrier->mount = CameraMount{carrier->name, RigidTransform::identity()};
  const CameraMount body = *carrier->mount;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int mount = network.frames[i].mount;
    if (mount < 0 || network.mounts[mount].locked[0]) continue;
    CameraMount adjusted{body.body, summary.cameraFromBody[mount] * body.cameraFromBody};
    if (!summary.mountAccuracy.empty())
      adjusted.offsetStdM = summary.mountAccuracy[mount].offsetStdM, adjusted.rotationStdRad = summary.mountAccuracy[mount].rotationStdRad;
    CameraRecord& camera = *project.findCamera(project.findFrame(frames[i])->camera);
    // Poses that are interpolated follow, where they were moved to the camera by the mount that it had.
    if (camera.mount && camera.mount->body == adjusted.body && setMount(project, camera.id, adjusted)) continue;
    camera.mount = std::move(adjusted);
  }
}

}  // namespace

Result<void> joinRig(Network& network, const std::vector<std::optional<CameraMount>>& kept, bool freeMounts) {
  if (network.cameras.size() < 2)
    return fail("All pictures are of one camera: there is no rig", {}, "Leave the rig out, or add the pictures of its other cameras");
  const auto moments = momentsOf(network);
  const int base = network.frames[moments.front().front()].camera;  // whatever the order of the rows
  std::vector<int> mountOfCamera(network.cameras.size(), -1);
  for (std::size_t c = 0; c < network.cameras.size(); ++c) {
    if (static_cast<int>(c) == base) continue;
    const bool known = kept[c] && kept[base] && kept[c]->body == kept[base]->body;
    const auto cameraFromBody = known ? kept[c]->cameraFromBody * kept[base]->cameraFromBody.inverse()
                                      : mountOf(network, moments, static_cast<int>(c), base);
    if (!cameraFromBody)
      return fail("No picture of camera '" + network.cameras[c].name + "' was taken at the moment of one of camera '" +
                      network.cameras[base].name + "', both with a pose",
                  {}, "Check the times of the pictures, or give poses of both for one moment");
    NetworkMount mount{network.cameras[c].name, *cameraFromBody};
    if (freeMounts) mount.locked.fill(false);
    mountOfCamera[c] = static_cast<int>(network.mounts.size());
    network.mounts.push_back(std::move(mount));
  }
  for (const PosePrior& prior : network.priors)
    for (const NetworkFrame& frame : network.frames)
      if (frame.pose == prior.pose && frame.camera != base)
        return fail("The position of frame '" + frame.name + "' is given, whose camera sits on a rig", {},
                    "Give the position of a frame of camera '" + network.cameras[base].name + "', which carries the rig");
  for (const std::vector<int>& moment : moments) {
    const auto onBase = std::find_if(moment.begin(), moment.end(), [&](int f) { return network.frames[f].camera == base; });
    const int body = network.frames[onBase == moment.end() ? moment.front() : *onBase].pose;
    for (const int f : moment) {
      NetworkFrame& frame = network.frames[f];
      frame.mount = mountOfCamera[frame.camera];
      // Of a moment that the base camera missed, the first picture says where the body is.
      if (frame.mount >= 0 && frame.pose == body && network.poses[body].bodyFromWorld)
        network.poses[body].bodyFromWorld = network.mounts[frame.mount].cameraFromBody.inverse() * *network.poses[body].bodyFromWorld;
      frame.pose = body;
    }
  }
  dropEmptyPoses(network);
  return {};
}

Result<NetworkClocks> holdToTrajectories(const Project& project, const std::vector<FrameId>& frames, bool freeClock, Network& network) {
  NetworkClocks clocks;
  std::map<TrajectoryId, std::size_t> ofTrajectory;
  std::vector<TrajectoryId> mounted;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = *project.findFrame(frames[i]);
    const Trajectory* trajectory = project.findTrajectory(frame.trajectory);
    if (!trajectory || trajectory->track.samples().size() < 2) continue;
    if (network.frames[i].mount >= 0) {
      if (std::find(mounted.begin(), mounted.end(), frame.trajectory) == mounted.end()) mounted.push_back(frame.trajectory);
      continue;
    }
    const auto [at, isNew] = ofTrajectory.emplace(frame.trajectory, network.trajectories.size());
    if (isNew) {
      NetworkTrajectory way;
      for (const PoseSample& sample : trajectory->track.samples())
        way.timeSecs.push_back(sample.timeSecs), way.bodyFromWorld.push_back(sample.cameraFromWorld);
      way.clockOffsetSecs = trajectory->clockOffsetSecs, way.clockFree = freeClock;
      network.trajectories.push_back(std::move(way));
      clocks.push_back({frame.trajectory});
    }
    NetworkTrajectory& way = network.trajectories[at->second];
    const double time = frame.timeSecs + way.clockOffsetSecs;
    if (time >= way.timeSecs.front() && time <= way.timeSecs.back()) way.poses.push_back(network.frames[i].pose);
  }
  if (clocks.empty()) return fail("No frame has a trajectory that its pose could be held to", project.path, "Add a trajectory with times: a TUM or EuRoC file");
  // Cameras of a rig run on the clock of the one that carries it.
  for (const TrajectoryId& id : mounted)
    if (!ofTrajectory.contains(id)) clocks.front().push_back(id);
  return clocks;
}

Result<NetworkClocks> tieMotion(const Project& project, const std::vector<FrameId>& frames, const MotionTies& ties, Network& network) {
  if (ties.rig || ties.freeMounts)
    if (const auto joined = joinRig(network, mountsOf(project, frames, network), ties.freeMounts); !joined) return fail(joined.error());
  if (!ties.trajectory && !ties.freeClock) return NetworkClocks();
  return holdToTrajectories(project, frames, ties.freeClock, network);
}

void applyMotion(Project& project, const std::vector<FrameId>& frames, const Network& network, const NetworkClocks& clocks,
                 const NetworkSummary& summary) {
  if (std::any_of(network.mounts.begin(), network.mounts.end(), [](const NetworkMount& mount) { return !mount.locked[0]; }))
    applyMounts(project, frames, network, summary);
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    if (!network.trajectories[i].clockFree) continue;
    for (const TrajectoryId& id : clocks[i]) {
      [[maybe_unused]] const auto posed = setClockOffset(project, id, summary.clockOffsetSecs[i], summary.clockStdSecs[i]);
      assert(posed);  // the trajectory was there when the network was made
    }
  }
}

}  // namespace alidade
