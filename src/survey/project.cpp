// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/project.h"

#include <algorithm>
#include <charconv>

namespace alidade {

namespace {

std::string stemOf(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

}  // namespace

const Frame* Project::findFrame(FrameId id) const {
  const auto it = std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return f.id == id; });
  return it == frames.end() ? nullptr : &*it;
}

Frame* Project::findFrame(FrameId id) {
  return const_cast<Frame*>(std::as_const(*this).findFrame(id));
}

const CameraRecord* Project::findCamera(CameraId id) const {
  const auto it = std::find_if(cameras.begin(), cameras.end(), [&](const CameraRecord& c) { return c.id == id; });
  return it == cameras.end() ? nullptr : &*it;
}

CameraRecord* Project::findCamera(CameraId id) {
  return const_cast<CameraRecord*>(std::as_const(*this).findCamera(id));
}

const Video* Project::findVideo(VideoId id) const {
  const auto it = std::find_if(videos.begin(), videos.end(), [&](const Video& v) { return v.id == id; });
  return it == videos.end() ? nullptr : &*it;
}

const Trajectory* Project::findTrajectory(TrajectoryId id) const {
  const auto it = std::find_if(trajectories.begin(), trajectories.end(), [&](const Trajectory& t) { return t.id == id; });
  return it == trajectories.end() ? nullptr : &*it;
}

Trajectory* Project::findTrajectory(TrajectoryId id) {
  return const_cast<Trajectory*>(std::as_const(*this).findTrajectory(id));
}

Result<FrameId> Project::frameByNameOrIndex(const std::string& text) const {
  for (const Frame& frame : frames)
    if (frame.name == text) return frame.id;
  for (const Frame& frame : frames)
    if (stemOf(frame.name) == text) return frame.id;
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), index);
  if (error == std::errc() && end == text.data() + text.size() && index < frames.size()) return frames[index].id;
  if (frames.empty()) return fail("The project has no frames", path, "Add images or a video with cameras");
  return fail("No frame is named '" + text + "'", path,
              "Name a frame, such as '" + frames.front().name + "', or give an index from 0 to " +
                  std::to_string(frames.size() - 1));
}

}  // namespace alidade
