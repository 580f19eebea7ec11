// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/pose_matching.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <unordered_map>

#include "app/pose_clock.h"
#include "plugin_api/picture_header.h"

namespace alidade {

namespace {

/// Lower case, slashes as separators, and without the ending where that is a picture's: "frame.0012" is a
/// name, "frame.jpg" has an ending.
std::string matchPath(const std::string& name) {
  std::string key = name;
  std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) { return std::tolower(c); });
  std::replace(key.begin(), key.end(), '\\', '/');
  const std::string extension = std::filesystem::path(key).extension().string();
  if (extension.size() > 1 && isPictureExtension(extension.substr(1))) key.resize(key.size() - extension.size());
  return key;
}

std::string lastPart(const std::string& path) { return path.substr(path.rfind('/') + 1); }

/// How many parts of two paths agree, counted from their ends.
std::size_t commonParts(std::string_view a, std::string_view b) {
  std::size_t parts = 0;
  for (;;) {
    const auto slashA = a.rfind('/'), slashB = b.rfind('/');
    if (a.substr(slashA + 1) != b.substr(slashB + 1)) return parts;
    ++parts;
    if (slashA == std::string_view::npos || slashB == std::string_view::npos) return parts;
    a = a.substr(0, slashA);
    b = b.substr(0, slashB);
  }
}

CameraId nextCameraId(const Project& project) {
  std::int64_t highest = 0;
  for (const auto& record : project.cameras) highest = std::max(highest, record.id.value);
  return CameraId{highest + 1};
}

/// The cameras of a set in the project: ids by the set's own index. A camera whose file states no picture size
/// enters the project with the first picture that uses it, once for every size.
class SetCameras {
 public:
  SetCameras(Project& project, const CameraSource& source);

  /// Nothing where the set has no such camera, or the frame's picture cannot be measured for one without size.
  std::optional<CameraId> forFrame(int camera, const Frame& frame);
  std::optional<CameraId> theOnlyOne() const { return m_ids.size() == 1 && m_ids[0] ? std::optional(m_ids[0]) : std::nullopt; }
  std::size_t unmeasured() const { return m_unmeasured; }

 private:
  CameraId add(const Intrinsics& intrinsics, int index);

  Project& m_project;
  const CameraSource& m_source;
  std::vector<CameraId> m_ids;
  std::map<std::tuple<int, int, int>, CameraId> m_sized;
  std::size_t m_unmeasured = 0;
};

CameraId SetCameras::add(const Intrinsics& intrinsics, int index) {
  const std::string stem = std::filesystem::path(m_source.path).stem().string();
  CameraRecord record;
  record.id = nextCameraId(m_project);
  record.name = m_source.set.cameras.size() == 1 ? stem : stem + " " + std::to_string(index + 1);
  if (!m_source.name.empty()) record.name = m_source.name;
  record.camera = Camera(intrinsics);
  record.mount = m_source.mount;
  const CameraId id = record.id;
  m_project.cameras.push_back(std::move(record));
  return id;
}

SetCameras::SetCameras(Project& project, const CameraSource& source) : m_project(project), m_source(source) {
  const auto& unsized = source.set.camerasWithoutSize;
  for (int i = 0; i < static_cast<int>(source.set.cameras.size()); ++i) {
    const bool hasSize = std::find(unsized.begin(), unsized.end(), i) == unsized.end();
    m_ids.push_back(hasSize ? add(source.set.cameras[std::size_t(i)], i) : CameraId{});
  }
}

std::optional<CameraId> SetCameras::forFrame(int camera, const Frame& frame) {
  if (camera < 0 || camera >= static_cast<int>(m_ids.size())) return std::nullopt;
  if (m_ids[std::size_t(camera)]) return m_ids[std::size_t(camera)];
  const auto header = frame.image.path.empty() ? Result<PictureHeader>(fail("")) : readPictureHeader(frame.image.path);
  if (!header) {
    ++m_unmeasured;
    return std::nullopt;
  }
  CameraId& id = m_sized[{camera, header->width, header->height}];
  if (!id) {
    Intrinsics intrinsics = m_source.set.cameras[std::size_t(camera)];
    intrinsics.width = header->width;
    intrinsics.height = header->height;
    intrinsics.cx = 0.5 * (header->width - 1);
    intrinsics.cy = 0.5 * (header->height - 1);
    id = add(intrinsics, camera);
  }
  return id;
}

bool hasNames(const CameraSet& set) {
  return std::any_of(set.pictures.begin(), set.pictures.end(), [](const auto& p) { return !p.name.empty(); });
}

void givePose(Frame& frame, const PosedPicture& picture, SetCameras& cameras, PoseSource how) {
  if (!frame.cameraFromWorld && picture.cameraFromWorld) {
    frame.cameraFromWorld = picture.cameraFromWorld;
    frame.poseSource = how;
  }
  if (!frame.camera)
    if (const auto camera = cameras.forFrame(picture.camera, frame)) frame.camera = *camera;
  if (picture.hasTime) frame.timeSecs = picture.timeSecs;
}

struct NameMatch {
  std::size_t left = 0;       ///< poses whose picture no frame is
  std::size_t ambiguous = 0;  ///< frames that several poses fit equally well
};

/// By the last part of the path; among several of that name by the most parts in common.
NameMatch matchByName(const std::vector<Frame*>& frames, const CameraSet& set, SetCameras& cameras) {
  std::vector<std::string> paths;
  std::unordered_map<std::string, std::vector<std::size_t>> byName;
  for (std::size_t i = 0; i < set.pictures.size(); ++i) {
    paths.push_back(matchPath(set.pictures[i].name));
    byName[lastPart(paths.back())].push_back(i);
  }
  std::vector<bool> taken(set.pictures.size(), false);
  NameMatch match;
  for (Frame* each : frames) {
    Frame& frame = *each;
    const std::string path = matchPath(frame.image.path.empty() ? frame.name : frame.image.path);
    auto found = byName.find(lastPart(path));
    if (found == byName.end()) found = byName.find(lastPart(matchPath(frame.name)));
    if (found == byName.end()) continue;
    std::size_t best = 0, most = 0, equal = 0;
    for (const std::size_t i : found->second) {
      const std::size_t parts = commonParts(path, paths[i]);
      if (parts > most || equal == 0) best = i, most = parts, equal = 1;
      else if (parts == most) ++equal;
    }
    if (equal > 1 && set.pictures[found->second.front()].name != set.pictures[found->second.back()].name) {
      ++match.ambiguous;
      continue;
    }
    givePose(frame, set.pictures[best], cameras, PoseSource::File);
    taken[best] = true;
  }
  for (std::size_t i = 0; i < taken.size(); ++i) match.left += !taken[i] && set.pictures[i].cameraFromWorld;
  return match;
}

PoseTrack trackOf(const CameraSet& set) {
  std::vector<PoseSample> samples;
  for (const auto& picture : set.pictures)
    if (picture.hasTime && picture.cameraFromWorld) samples.push_back({picture.timeSecs, *picture.cameraFromWorld});
  return PoseTrack(std::move(samples));
}

TrajectoryId addTrajectory(Project& project, const std::string& path, PoseTrack track) {
  Trajectory trajectory;
  for (const Trajectory& there : project.trajectories) trajectory.id.value = std::max(trajectory.id.value, there.id.value);
  ++trajectory.id.value;
  trajectory.name = std::filesystem::path(path).stem().string();
  trajectory.source.path = std::filesystem::absolute(path).lexically_normal().string();
  trajectory.track = std::move(track);
  project.trajectories.push_back(std::move(trajectory));
  return project.trajectories.back().id;
}

bool haveTimes(const std::vector<Frame*>& frames) {
  return frames.size() > 1 && frames.back()->timeSecs > frames.front()->timeSecs;
}

/// A video has a clock of its own, which need not be the trajectory's; a folder of pictures has none.
bool isOfVideo(const std::vector<Frame*>& frames) {
  return std::all_of(frames.begin(), frames.end(), [](const Frame* f) { return bool(f->video); });
}

/// Two clocks that never agree (one counts from 1970, the other from the video's start) are first laid start on start.
void layStartOnStart(Trajectory& trajectory, const std::vector<Frame*>& frames, std::vector<std::string>& notes) {
  const auto& samples = trajectory.track.samples();
  const bool apart = frames.back()->timeSecs < samples.front().timeSecs || frames.front()->timeSecs > samples.back().timeSecs;
  if (!apart) return;
  trajectory.clockOffsetSecs = samples.front().timeSecs - frames.front()->timeSecs;
  notes.push_back("The clock of " + trajectory.source.path + " is not the pictures': its start was laid on theirs. "
                  "Estimate the clock offset, or set it");
}

/// True where the trajectory could be laid on the frames at all.
bool matchTrajectory(Project& project, const std::vector<Frame*>& frames, const CameraSource& source, SetCameras& cameras,
                     std::vector<std::string>& notes) {
  const CameraSet& set = source.set;
  PoseTrack track = trackOf(set);
  const bool byOrder = set.pictures.size() == frames.size() && (!isOfVideo(frames) || track.empty());
  if (!byOrder && (!haveTimes(frames) || track.empty())) return false;
  const bool hasTrack = track.samples().size() > 1;
  const TrajectoryId id = hasTrack ? addTrajectory(project, source.path, std::move(track)) : TrajectoryId{};
  Trajectory* trajectory = project.findTrajectory(id);
  for (Frame* frame : frames)
    if (!frame->cameraFromWorld || frame->poseSource == PoseSource::None) frame->trajectory = id;
  if (byOrder) {
    for (std::size_t i = 0; i < frames.size(); ++i) givePose(*frames[i], set.pictures[i], cameras, PoseSource::File);
    return true;
  }
  if (!trajectory) return false;
  layStartOnStart(*trajectory, frames, notes);
  const PoseCount poses = poseFromTrajectory(project, id);
  if (poses.posed > 0)
    for (Frame* frame : frames)
      if (!frame->camera)
        if (const auto camera = cameras.theOnlyOne()) frame->camera = *camera;
  if (poses.posed == 0) project.trajectories.pop_back();
  return poses.posed > 0;
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

/// A pose without a name goes to no frame that another source brought along.
std::vector<Frame*> framesOf(Project& project, const CameraSource& source, const std::vector<CameraSource>& all) {
  std::vector<Frame*> frames;
  const auto names = [](const CameraSource& of, const Frame& frame) { return std::find(of.only.begin(), of.only.end(), frame.id) != of.only.end(); };
  const auto serves = [&](const Frame& frame) {
    if (!source.only.empty()) return names(source, frame);
    return hasNames(source.set) || std::none_of(all.begin(), all.end(), [&](const CameraSource& other) { return names(other, frame); });
  };
  for (Frame& frame : project.frames)
    if (serves(frame)) frames.push_back(&frame);
  return frames;
}

void noteGaps(const Project& project, std::vector<std::string>& notes) {
  std::size_t poseless = 0, cameraless = 0, lensless = 0;
  for (const Frame& frame : project.frames) {
    poseless += !frame.cameraFromWorld;
    cameraless += !frame.camera;
    lensless += frame.cameraFromWorld && !frame.camera;
  }
  if (poseless > 0)
    notes.push_back(count(poseless, "picture has", "pictures have") +
                    " no pose. Add cameras that name " + (poseless == 1 ? "it" : "them") + ", or a trajectory that covers " +
                    (poseless == 1 ? "its time" : "their times"));
  if (cameraless > 0)
    notes.push_back(count(cameraless, "picture has", "pictures have") +
                    " no camera" + (lensless == 0 ? "" : lensless == cameraless ? ": the pose is there, the lens is missing" : "") +
                    ". Add a calibration: a COLMAP model or an OpenCV calibration file");
}

}  // namespace

CameraSet rigCameraSet(const CameraSet& sensorTrajectory, const RigidTransform& sensorFromCamera, const Intrinsics& intrinsics,
                       double timeOffsetSecs) {
  CameraSet set;
  set.cameras = {intrinsics};
  set.pictures = sensorTrajectory.pictures;
  const RigidTransform cameraFromSensor = sensorFromCamera.inverse();
  for (PosedPicture& picture : set.pictures) {
    picture.camera = 0;
    picture.timeSecs -= timeOffsetSecs;
    if (picture.cameraFromWorld) picture.cameraFromWorld = cameraFromSensor * *picture.cameraFromWorld;
  }
  return set;
}

std::vector<std::string> matchPoses(Project& project, const std::vector<CameraSource>& sources) {
  std::vector<std::string> notes;
  std::optional<CameraId> calibration;
  for (const CameraSource& source : sources) {
    SetCameras cameras(project, source);
    const CameraSet& set = source.set;
    if (set.pictures.empty() && !calibration) calibration = cameras.theOnlyOne();
    for (const auto& warning : set.warnings) notes.push_back(warning.what + " (" + warning.where + ")");
    const std::vector<Frame*> frames = framesOf(project, source, sources);
    if (set.pictures.empty() || frames.empty()) continue;
    if (hasNames(set)) {
      const auto [left, ambiguous] = matchByName(frames, set, cameras);
      if (ambiguous > 0)
        notes.push_back(count(ambiguous, "picture is", "pictures are") + " named like several in " + source.path +
                        ": none was chosen. Keep the pictures in folders called as there");
      if (left > 0)
        notes.push_back(count(left, "pose of ", "poses of ") + source.path + (left == 1 ? " has" : " have") +
                        " no picture here. Add the folder that holds them if they are wanted");
    } else if (!matchTrajectory(project, frames, source, cameras, notes)) {
      notes.push_back("The trajectory " + source.path + " could not be laid on the pictures: they have no times, and it has " +
                      count(set.pictures.size(), "pose", "poses") + " for " +
                      count(frames.size(), "picture", "pictures") +
                      ". Add a COLMAP model that names the pictures, or the video itself");
    }
    if (cameras.unmeasured() > 0)
      notes.push_back(source.path + " states no picture size, and " + count(cameras.unmeasured(), "picture", "pictures") +
                      " could not be measured for it. Add a calibration file");
  }
  shareTheOnlyCamera(project);
  // A calibration beside poses without cameras: whoever is still without takes it. Never some model's camera: it is
  // another picture's.
  for (Frame& frame : project.frames)
    if (!frame.camera && frame.cameraFromWorld && calibration) frame.camera = *calibration;
  dropUnusedCameras(project);
  noteGaps(project, notes);
  return notes;
}

}  // namespace alidade
