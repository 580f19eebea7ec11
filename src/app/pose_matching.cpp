// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/pose_matching.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <unordered_map>

namespace alidade {

namespace {

std::string matchKey(const std::string& name) {
  std::string key = std::filesystem::path(name).stem().string();
  std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
  return key;
}

CameraId nextCameraId(const Project& project) {
  std::int64_t highest = 0;
  for (const auto& record : project.cameras) highest = std::max(highest, record.id.value);
  return CameraId{highest + 1};
}

/// Adds the cameras of a set to the project; the ids by the set's own index.
std::vector<CameraId> addCameras(Project& project, const CameraSource& source) {
  std::vector<CameraId> ids;
  const std::string stem = std::filesystem::path(source.path).stem().string();
  for (std::size_t i = 0; i < source.set.cameras.size(); ++i) {
    CameraRecord record;
    record.id = nextCameraId(project);
    record.name = source.set.cameras.size() == 1 ? stem : stem + " " + std::to_string(i + 1);
    record.camera = Camera(source.set.cameras[i]);
    ids.push_back(record.id);
    project.cameras.push_back(std::move(record));
  }
  return ids;
}

bool hasNames(const CameraSet& set) {
  return std::any_of(set.pictures.begin(), set.pictures.end(), [](const auto& p) { return !p.name.empty(); });
}

void givePose(Frame& frame, const PosedPicture& picture, const std::vector<CameraId>& ids, PoseSource how) {
  if (!frame.cameraFromWorld && picture.cameraFromWorld) {
    frame.cameraFromWorld = picture.cameraFromWorld;
    frame.poseSource = how;
  }
  if (!frame.camera && picture.camera >= 0 && picture.camera < static_cast<int>(ids.size()))
    frame.camera = ids[picture.camera];
  if (picture.hasTime) frame.timeSecs = picture.timeSecs;
}

/// Poses whose picture name no frame has.
std::size_t matchByName(Project& project, const CameraSet& set, const std::vector<CameraId>& ids) {
  std::unordered_map<std::string, const PosedPicture*> byKey;
  for (const auto& picture : set.pictures) byKey.emplace(matchKey(picture.name), &picture);
  std::size_t matched = 0;
  for (Frame& frame : project.frames) {
    const auto it = byKey.find(matchKey(frame.name));
    if (it == byKey.end()) continue;
    givePose(frame, *it->second, ids, PoseSource::File);
    ++matched;
  }
  return byKey.size() - matched;
}

/// A trajectory: poses by time, sorted.
struct Trajectory {
  std::vector<const PosedPicture*> poses;
  double step = 0;  // median

  explicit Trajectory(const CameraSet& set) {
    for (const auto& picture : set.pictures)
      if (picture.hasTime && picture.cameraFromWorld) poses.push_back(&picture);
    std::stable_sort(poses.begin(), poses.end(), [](auto* a, auto* b) { return a->timeSecs < b->timeSecs; });
    std::vector<double> steps;
    for (std::size_t i = 1; i < poses.size(); ++i) steps.push_back(poses[i]->timeSecs - poses[i - 1]->timeSecs);
    if (steps.empty()) return;
    std::nth_element(steps.begin(), steps.begin() + steps.size() / 2, steps.end());
    step = steps[steps.size() / 2];
  }

  std::optional<RigidTransform> at(double time) const {
    if (poses.empty()) return std::nullopt;
    const double slack = 1e-3 + 0.01 * step;
    const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                        [](const PosedPicture* p, double t) { return p->timeSecs < t; });
    if (after == poses.end())
      return time - poses.back()->timeSecs <= slack ? poses.back()->cameraFromWorld : std::nullopt;
    if (after == poses.begin())
      return poses.front()->timeSecs - time <= slack ? poses.front()->cameraFromWorld : std::nullopt;
    const PosedPicture& a = **(after - 1);
    const PosedPicture& b = **after;
    const double gap = b.timeSecs - a.timeSecs;
    if (gap > 3 * step) return std::nullopt;
    if (!(gap > 0)) return b.cameraFromWorld;
    return interpolateCameraPose(*a.cameraFromWorld, *b.cameraFromWorld, (time - a.timeSecs) / gap);
  }
};

bool framesHaveTimes(const Project& project) {
  return project.frames.size() > 1 && project.frames.back().timeSecs > project.frames.front().timeSecs;
}

/// True where the trajectory could be laid on the frames at all.
bool matchTrajectory(Project& project, const CameraSet& set, const std::vector<CameraId>& ids) {
  if (set.pictures.size() == project.frames.size()) {
    for (std::size_t i = 0; i < project.frames.size(); ++i)
      givePose(project.frames[i], set.pictures[i], ids, PoseSource::File);
    return true;
  }
  if (!framesHaveTimes(project)) return false;
  const Trajectory trajectory(set);
  bool any = false;
  for (Frame& frame : project.frames) {
    if (frame.cameraFromWorld) continue;
    frame.cameraFromWorld = trajectory.at(frame.timeSecs);
    if (!frame.cameraFromWorld) continue;
    frame.poseSource = PoseSource::Interpolated;
    any = true;
  }
  return any;
}

std::string count(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// Frames still without a camera take the project's only one.
void shareTheOnlyCamera(Project& project) {
  if (project.cameras.size() != 1) return;
  for (Frame& frame : project.frames)
    if (!frame.camera) frame.camera = project.cameras.front().id;
}

/// A model's unused cameras only clutter the project; a project without any camera in use keeps all.
void dropUnusedCameras(Project& project) {
  const auto used = [&](const CameraRecord& record) {
    return std::any_of(project.frames.begin(), project.frames.end(), [&](const Frame& f) { return f.camera == record.id; });
  };
  if (std::any_of(project.cameras.begin(), project.cameras.end(), used))
    std::erase_if(project.cameras, [&](const CameraRecord& record) { return !used(record); });
}

void noteGaps(const Project& project, std::vector<std::string>& notes) {
  std::size_t poseless = 0, cameraless = 0;
  for (const Frame& frame : project.frames) {
    poseless += !frame.cameraFromWorld;
    cameraless += !frame.camera;
  }
  if (poseless > 0)
    notes.push_back(count(poseless, "picture has", "pictures have") +
                    " no pose. Add a COLMAP model that names it, or a trajectory that covers its time");
  if (cameraless > 0)
    notes.push_back(count(cameraless, "picture has", "pictures have") +
                    " no camera. Add a calibration: a COLMAP model or an OpenCV calibration file");
}

}  // namespace

std::vector<std::string> matchPoses(Project& project, const std::vector<CameraSource>& sources) {
  std::vector<std::string> notes;
  for (const CameraSource& source : sources) {
    const std::vector<CameraId> ids = addCameras(project, source);
    const CameraSet& set = source.set;
    for (const auto& warning : set.warnings) notes.push_back(warning.what + " (" + warning.where + ")");
    if (set.pictures.empty() || project.frames.empty()) continue;
    if (hasNames(set)) {
      const std::size_t left = matchByName(project, set, ids);
      if (left > 0)
        notes.push_back(count(left, "pose of ", "poses of ") + source.path + (left == 1 ? " has" : " have") +
                        " no picture here. Add the folder that holds them if they are wanted");
    } else if (!matchTrajectory(project, set, ids)) {
      notes.push_back("The trajectory " + source.path + " could not be laid on the pictures: they have no times, and it has " +
                      count(set.pictures.size(), "pose", "poses") + " for " +
                      count(project.frames.size(), "picture", "pictures") +
                      ". Add a COLMAP model that names the pictures, or the video itself");
    }
  }
  shareTheOnlyCamera(project);
  // A calibration without pictures beside a model that names them: whoever is still without takes the first.
  for (Frame& frame : project.frames)
    if (!frame.camera && frame.cameraFromWorld && !project.cameras.empty()) frame.camera = project.cameras.front().id;
  dropUnusedCameras(project);
  noteGaps(project, notes);
  return notes;
}

}  // namespace alidade
