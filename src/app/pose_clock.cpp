// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/pose_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace alidade {

namespace {

/// The velocity over the poses of the frames around, of one camera and one source.
std::optional<Twist> motionOverFrames(const Project& project, const Frame& frame) {
  constexpr double kFarthestSecs = 1.0;
  std::vector<PoseSample> samples;
  const auto at = static_cast<std::ptrdiff_t>(&frame - project.frames.data());
  const auto count = static_cast<std::ptrdiff_t>(project.frames.size());
  if (at < 0 || at >= count) return std::nullopt;
  const auto look = [&](std::ptrdiff_t step) {
    for (std::ptrdiff_t i = at + step; i >= 0 && i < count; i += step) {
      const Frame& other = project.frames[static_cast<std::size_t>(i)];
      if (std::abs(other.timeSecs - frame.timeSecs) > kFarthestSecs) return;
      if (other.camera != frame.camera || other.video != frame.video || !other.cameraFromWorld) continue;
      samples.push_back({other.timeSecs, *other.cameraFromWorld});
      return;
    }
  };
  look(-1);
  samples.push_back({frame.timeSecs, *frame.cameraFromWorld});
  look(1);
  if (samples.size() < 2) return std::nullopt;
  const PoseTrack track(std::move(samples));
  const double span = track.samples().back().timeSecs - track.samples().front().timeSecs;
  return track.motionAt(0.5 * (track.samples().back().timeSecs + track.samples().front().timeSecs), span * (1 - 1e-12));
}

/// Refuses an offset with which none of the frames that the trajectory serves has a pose.
Result<void> checkOffsetMeets(const Project& project, const Trajectory& trajectory, double offsetSecs) {
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const Frame& frame : project.frames) {
    if (frame.trajectory != trajectory.id) continue;
    if (trajectory.track.at(frame.timeSecs + offsetSecs).cameraFromWorld) return {};
    first = std::min(first, frame.timeSecs), last = std::max(last, frame.timeSecs);
  }
  const auto& samples = trajectory.track.samples();
  if (first > last || samples.empty()) return {};
  return fail(fmt::format("With a clock offset of {:g} s no frame has a pose", offsetSecs), trajectory.name,
              fmt::format("The frames are of {:.3f} to {:.3f} s, the poses of {:.3f} to {:.3f} s: give an offset between {:.3f} and {:.3f} s",
                          first, last, samples.front().timeSecs, samples.back().timeSecs, samples.front().timeSecs - last,
                          samples.back().timeSecs - first));
}

}  // namespace

std::string poseCountText(const PoseCount& count) {
  std::string text = fmt::format("{} {} a pose", count.posed, count.posed == 1 ? "frame has" : "frames have");
  for (const auto& [gap, frames] : count.without)
    text += fmt::format("; {} {} none: {}", frames, frames == 1 ? "has" : "have", poseGapText(gap));
  return text;
}

PoseCount poseFromTrajectory(Project& project, TrajectoryId id) {
  PoseCount count;
  const Trajectory* trajectory = project.findTrajectory(id);
  if (!trajectory) return count;
  for (Frame& frame : project.frames) {
    if (frame.trajectory != id) continue;
    const PoseTrack::Answer answer = trajectory->track.at(frame.timeSecs + trajectory->clockOffsetSecs);
    if (frame.poseSource == PoseSource::Refined) {
      ++count.posed;
      continue;
    }
    frame.cameraFromWorld = answer.cameraFromWorld;
    frame.poseSource = answer.cameraFromWorld ? PoseSource::Interpolated : PoseSource::None;
    if (answer.cameraFromWorld) ++count.posed;
    else ++count.without[answer.gap];
  }
  return count;
}

Result<PoseCount> setClockOffset(Project& project, TrajectoryId id, double offsetSecs, std::optional<double> stdSecs) {
  Trajectory* trajectory = project.findTrajectory(id);
  if (!trajectory) return fail("The project has no such trajectory", project.path, "Add one: a TUM or EuRoC file of timed poses");
  if (!std::isfinite(offsetSecs)) return fail("The clock offset is no time", project.path, "Give seconds");
  if (auto meets = checkOffsetMeets(project, *trajectory, offsetSecs); !meets) return fail(meets.error());
  trajectory->clockOffsetSecs = offsetSecs;
  trajectory->clockOffsetStdSecs = stdSecs;
  return poseFromTrajectory(project, id);
}

Result<TrajectoryId> trajectoryByName(const Project& project, const std::string& name) {
  std::string names;
  for (const Trajectory& trajectory : project.trajectories) {
    if (trajectory.name == name) return trajectory.id;
    names += (names.empty() ? "'" : ", '") + trajectory.name + "'";
  }
  if (project.trajectories.empty())
    return fail("The project has no trajectory, so there is no clock to set", project.path,
                "Add a trajectory with times: a TUM or EuRoC file");
  if (name.empty() && project.trajectories.size() == 1) return project.trajectories.front().id;
  if (name.empty()) return fail("The project has several trajectories", project.path, "Name one of " + names);
  return fail("No trajectory is named '" + name + "'", project.path, "Name one of " + names);
}

RollingShutter shutterOf(const Project& project, const Frame& frame) {
  RollingShutter shutter;
  const CameraRecord* camera = project.findCamera(frame.camera);
  if (!camera || camera->readoutSecs == 0 || !frame.cameraFromWorld) return shutter;
  std::optional<Twist> motion;
  if (const Trajectory* trajectory = project.findTrajectory(frame.trajectory))
    motion = trajectory->track.motionAt(frame.timeSecs + trajectory->clockOffsetSecs,
                                        std::max(std::abs(camera->readoutSecs), 1e-3));
  if (!motion) motion = motionOverFrames(project, frame);
  if (!motion) return shutter;
  shutter.readoutSecs = camera->readoutSecs;
  shutter.motion = *motion;
  return shutter;
}

}  // namespace alidade
