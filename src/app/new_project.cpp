// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include "app/jobs.h"
#include "app/pose_matching.h"
#include "cloud/store_folder.h"
#include "io/picture_file.h"
#include "io/project_store.h"
#include "io/reader_registry.h"
#include "io/rig_file.h"
#include "io/video_writer.h"
#include "plugin_api/euroc_sensor.h"
#include "plugin_api/picture_header.h"
#include "simulate/camera_path.h"
#include "simulate/pose_writer.h"

namespace alidade {

namespace {

constexpr double kNominalFramesPerSecond = 15.0;

std::string stemOf(const std::string& path) {
  std::filesystem::path p(path);
  if (!p.has_filename()) p = p.parent_path();
  return p.stem().string();
}

std::string absolute(const std::string& path) {
  std::error_code ignored;
  auto full = std::filesystem::weakly_canonical(path, ignored);
  return ignored || full.empty() ? path : full.string();
}

template <class T>
std::int64_t nextId(const std::vector<T>& items) {
  std::int64_t highest = 0;
  for (const auto& item : items) highest = std::max(highest, item.id.value);
  return highest + 1;
}

/// The EPSG number of "EPSG:n" or of the outermost (so last) AUTHORITY or ID of a WKT; empty where
/// none is stated.
std::string epsgOf(const std::string& crs) {
  const auto at = crs.rfind("EPSG");
  if (at == std::string::npos) return {};
  const auto from = crs.find_first_of("0123456789", at);
  if (from == std::string::npos) return {};
  return crs.substr(from, crs.find_first_not_of("0123456789", from) - from);
}

bool sameCrs(const std::string& a, const std::string& b) {
  return a == b || (!epsgOf(a).empty() && epsgOf(a) == epsgOf(b));
}

/// Builds a project step by step; each add... inspects one input.
class Assembler {
 public:
  Assembler(Project project, const Progress& progress) : m_progress(progress) { m_outcome.project = std::move(project); }

  Result<void> addScan(const std::string& path) {
    if (isStoreFolder(path)) return addStore(path);
    const auto reader = ReaderRegistry::instance().findAs<ScanReader>(path);
    if (!reader) return fail(reader.error());
    auto info = (*reader)->inspect(path);
    if (!info) return fail(info.error());
    auto source = describeSource(path);
    if (!source) return fail(source.error());
    Scan scan;
    scan.id.value = nextId(project().scans);
    scan.name = stemOf(path);
    scan.source = std::move(*source);
    if (isThere(project().scans, scan.source)) return {};
    scan.info = std::move(*info);
    noteCrs(scan.info.crs, path);
    project().scans.push_back(std::move(scan));
    return {};
  }

  /// A point store is a scan that is ready to draw: it is used where it lies.
  Result<void> addStore(const std::string& path) {
    const auto store = openStore(path);
    if (!store) return fail(store.error());
    Scan scan;
    scan.id.value = nextId(project().scans);
    scan.name = stemOf(path);
    scan.source.path = absolute(path);
    if (isThere(project().scans, scan.source)) return {};
    if (!store->parts.empty()) scan.info = store->parts.front().manifest.info;
    scan.info.pointCount = 0;
    for (const StorePart& part : store->parts) {
      scan.info.pointCount += part.points->pointCount();
      scan.info.bounds.add(part.points->bounds());
    }
    noteCrs(scan.info.crs, path);
    project().scans.push_back(std::move(scan));
    return {};
  }

  /// A file of scans may hold pictures and their cameras as well (E57). One of pictures alone is no scan that failed, unless
  /// a scan was asked for.
  Result<void> addScanWithPictures(const std::string& path, bool scanWanted) {
    if (isStoreFolder(path)) return addStore(path);
    const auto pictures = ReaderRegistry::instance().findAs<PictureReader>(path);
    const auto& videos = project().videos;
    const std::string full = absolute(path);
    const bool there = std::any_of(videos.begin(), videos.end(), [&](const Video& video) { return video.source.path == full; });
    if (there || !pictures || !(*pictures)->inspect(path)) return addScan(path);
    if (const auto scan = addScan(path); !scan) {
      if (scanWanted) return scan;
      m_outcome.notes.push_back("No scan was taken from " + path + ": " + scan.error().what);
    }
    return addPicturesIn(path);
  }

  Result<void> addDesign(const std::string& path) {
    const auto reader = ReaderRegistry::instance().findAs<DesignReader>(path);
    if (!reader) return fail(reader.error());
    auto info = (*reader)->inspect(path);
    if (!info) return fail(info.error());
    auto source = describeSource(path);
    if (!source) return fail(source.error());
    Design design;
    design.id.value = nextId(project().designs);
    design.name = stemOf(path);
    design.source = std::move(*source);
    if (isThere(project().designs, design.source)) return {};
    noteCrs(info->crs, path);
    project().designs.push_back(std::move(design));
    return {};
  }

  Result<void> addPictures(const std::string& path) {
    const auto reader = ReaderRegistry::instance().findAs<PictureReader>(path);
    if (!reader) return fail(reader.error());
    auto set = (*reader)->inspect(path);
    if (!set) return fail(set.error());
    return set->isVideo ? addVideo(path, *set) : addPictureFiles(*set);
  }

  Result<void> addCameras(const std::string& path) {
    auto set = inspectCameras(path);
    if (!set) return fail(set.error());
    m_cameras.push_back({path, std::move(*set), {}});
    return {};
  }

  /// As the rig file says it, else the camera's own calibration.
  static Result<RigidTransform> mountingOf(const RigCamera& camera, const std::string& path) {
    if (camera.sensorFromCamera) return *camera.sensorFromCamera;
    const auto sensor = readEurocSensor(camera.calibration);
    if (!sensor) return fail(sensor.error());
    if (!*sensor)
      return fail("Neither the rig file nor the calibration says where camera '" + camera.name + "' sits on the sensor", path,
                  "Add sensor_from_camera or device to the rig file");
    return (*sensor)->bodyFromSensor;
  }

  /// Every camera of the rig brings its own pictures, and the sensor's trajectory moved to its place.
  Result<void> addRig(const std::string& path) {
    const auto rig = readRigFile(path);
    if (!rig) return fail(rig.error());
    const auto trajectory = inspectCameras(rig->trajectory);
    if (!trajectory) return fail(trajectory.error());
    for (const RigCamera& camera : rig->cameras) {
      auto calibration = inspectCameras(camera.calibration);
      if (!calibration) return fail(calibration.error());
      if (calibration->cameras.size() != 1)
        return fail("The calibration describes " + std::to_string(calibration->cameras.size()) + " cameras, not one", camera.calibration,
                    "Give every camera of the rig a calibration file of its own");
      const auto mounting = mountingOf(camera, path);
      if (!mounting) return fail(mounting.error());
      const std::size_t before = project().frames.size();
      if (auto added = addPictures(camera.pictures); !added) return added;
      CameraSource source{path, rigCameraSet(*trajectory, *mounting, calibration->cameras.front(), rig->timeOffsetSecs)};
      source.name = camera.name;
      source.mount = CameraMount{stemOf(rig->trajectory), mounting->inverse()};
      for (std::size_t i = before; i < project().frames.size(); ++i) {
        Frame& frame = project().frames[i];
        if (camera.rateHz) frame.timeSecs = camera.startSecs + static_cast<double>(i - before) / *camera.rateHz;
        source.only.push_back(frame.id);
      }
      if (!source.only.empty()) m_cameras.push_back(std::move(source));
    }
    return {};
  }

  Result<void> addPoints(const std::string& path, bool control) {
    const auto reader = ReaderRegistry::instance().findAs<PointListReader>(path);
    if (!reader) return fail(reader.error());
    auto list = (*reader)->read(path);
    if (!list) return fail(list.error());
    for (const auto& warning : list->warnings) m_outcome.notes.push_back(warning.what + " (" + warning.where + ")");
    for (const StakePoint& point : list->points) {
      if (control) project().controlPoints.push_back({point.name, point.position, 0.003});
      else project().stakePoints.push_back(point);
    }
    return {};
  }

  /// By what the file is. A CSV named like control points is taken for such.
  Result<void> addAnything(const std::string& path) {
    if (isStoreFolder(path)) return addStore(path);
    const auto reader = ReaderRegistry::instance().find(path);
    if (!reader) return fail(reader.error());
    switch ((*reader)->kind()) {
      case ReaderKind::Scan: return addScanWithPictures(path, false);
      case ReaderKind::Design: return addDesign(path);
      case ReaderKind::Pictures: return addPicturesWithSidecars(path);
      case ReaderKind::Cameras: return addCameras(path);
      case ReaderKind::Points: return addPoints(path, stemOf(path).find("control") != std::string::npos);
    }
    return {};
  }

  NewProjectOutcome finish() {
    auto notes = matchPoses(project(), m_cameras);
    m_outcome.notes.insert(m_outcome.notes.end(), notes.begin(), notes.end());
    giveTimes();
    std::stable_sort(project().frames.begin(), project().frames.end(),
                     [](const Frame& a, const Frame& b) { return a.timeSecs < b.timeSecs; });
    noteDistance();
    noteSizes();
    if (!m_cameras.empty() && project().frames.empty())
      m_outcome.notes.push_back("Cameras and poses are of no use without pictures: add the pictures or the video they belong to");
    return std::move(m_outcome);
  }

  const Progress& progress() const { return m_progress; }
  Project& project() { return m_outcome.project; }

 private:
  /// A folder may hold its pictures' cameras beside them (XMP).
  Result<void> addPicturesWithSidecars(const std::string& path) {
    std::error_code ignored;
    const bool sidecars = std::filesystem::is_directory(path, ignored) && ReaderRegistry::instance().findAs<CameraReader>(path);
    if (auto added = addPictures(path); !added || !sidecars) return added;
    return addCameras(path);
  }

  /// Pictures in a file of scans, with their cameras.
  Result<void> addPicturesIn(const std::string& path) {
    const std::size_t before = project().frames.size();
    if (auto added = addPictures(path); !added) return added;
    if (project().frames.size() == before || !ReaderRegistry::instance().findAs<CameraReader>(path)) return {};
    auto set = inspectCameras(path);
    if (!set) return fail(set.error());
    CameraSource source{path, std::move(*set), {}};
    for (std::size_t i = before; i < project().frames.size(); ++i) source.only.push_back(project().frames[i].id);
    m_cameras.push_back(std::move(source));
    return {};
  }

  static Result<CameraSet> inspectCameras(const std::string& path) {
    const auto reader = ReaderRegistry::instance().findAs<CameraReader>(path);
    if (!reader) return fail(reader.error());
    return (*reader)->inspect(path);
  }

  Result<void> addVideo(const std::string& path, const PictureSetInfo& set) {
    auto source = describeSource(path);
    if (!source) return fail(source.error());
    if (isThere(project().videos, *source)) return {};
    Video video;
    video.id.value = nextId(project().videos);
    video.name = stemOf(path);
    video.source = std::move(*source);
    video.framesPerSecond = set.framesPerSecond;
    video.frameCount = static_cast<std::int64_t>(set.pictures.size());
    for (std::size_t i = 1; i < set.pictures.size(); ++i) {
      if (set.framesPerSecond == 0 || set.pictures[i].timeSecs > set.pictures[i - 1].timeSecs) continue;
      m_outcome.notes.push_back("The time stamps of " + path + " do not rise at frame " + std::to_string(i) +
                                ": poses cannot be laid on them. Give it times of its own: alidade-cli clock --rate or --times");
      break;
    }
    for (std::size_t i = 0; i < set.pictures.size(); ++i) {
      Frame frame;
      frame.id.value = nextFrameId();
      frame.name = set.pictures[i].name;
      frame.timeSecs = set.pictures[i].timeSecs;
      frame.video = video.id;
      frame.videoFrame = static_cast<std::int64_t>(i);
      project().frames.push_back(std::move(frame));
    }
    // The pictures of a scan may differ in size, those of a video do not.
    if (set.framesPerSecond > 0) m_videoSizes[video.id.value] = {set.width, set.height};
    project().videos.push_back(std::move(video));
    return {};
  }

  Result<void> addPictureFiles(const PictureSetInfo& set) {
    for (std::size_t i = 0; i < set.pictures.size(); ++i) {
      if (m_progress.cancelled()) return fail(cancelledError());
      m_progress.report(static_cast<double>(i) / static_cast<double>(set.pictures.size()), "Looking at pictures");
      const std::string path = absolute(set.pictures[i].path);
      const auto& frames = project().frames;
      if (std::any_of(frames.begin(), frames.end(), [&](const Frame& f) { return f.image.path == path; })) continue;
      auto source = describeSource(path);
      if (!source) return fail(source.error());
      Frame frame;
      frame.id.value = nextFrameId();
      frame.name = set.pictures[i].name;
      frame.timeSecs = set.pictures[i].timeSecs;
      frame.image = std::move(*source);
      project().frames.push_back(std::move(frame));
    }
    return {};
  }

  std::int64_t nextFrameId() {
    if (m_nextFrame == 0) m_nextFrame = nextId(project().frames);
    return m_nextFrame++;
  }

  /// The same file twice would be drawn twice and counted twice.
  template <class T>
  bool isThere(const std::vector<T>& items, const SourceFile& source) {
    if (std::none_of(items.begin(), items.end(), [&](const T& item) { return item.source.path == source.path; })) return false;
    m_outcome.notes.push_back(source.path + " is in the project already");
    return true;
  }

  void noteCrs(const std::string& crs, const std::string& path) {
    if (crs.empty()) return;
    if (project().crs.empty()) project().crs = crs;
    else if (!sameCrs(project().crs, crs))
      m_outcome.notes.push_back(path + " states another coordinate system than the project. Coordinates are used as they "
                                       "stand: check that the two agree");
  }

  /// Pictures of a folder have no clock: a nominal rate makes them playable.
  void giveTimes() {
    auto& frames = project().frames;
    if (frames.size() < 2) return;
    const bool anyTime = std::any_of(frames.begin(), frames.end(), [](const Frame& f) { return f.timeSecs != 0; });
    if (anyTime) return;
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].timeSecs = static_cast<double>(i) / kNominalFramesPerSecond;
    m_outcome.notes.push_back("The pictures carry no times: 15 a second are assumed. Add a trajectory with times if it matters");
  }

  /// Cameras far from the scan are the commonest sign of two coordinate systems.
  void noteDistance() {
    Bounds scanned;
    for (const Scan& scan : project().scans) scanned.add(scan.info.bounds);
    if (scanned.empty()) return;
    const double reach = 3 * scanned.diagonal() + 500;
    for (const Frame& frame : project().frames) {
      if (!frame.cameraFromWorld) continue;
      const double distance = glm::length(frame.cameraFromWorld->centre() - scanned.centre());
      if (distance < reach) return;
      m_outcome.notes.push_back("The cameras stand " + std::to_string(std::llround(distance)) +
                                " m from the scan. Are both in the same coordinate system?");
      return;
    }
  }

  /// By the first picture of each camera: a calibration of another size is another camera's, or one of scaled pictures.
  void noteSizes() {
    for (const CameraRecord& camera : project().cameras) {
      const auto& frames = project().frames;
      const auto first = std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return f.camera == camera.id; });
      if (first == frames.end()) continue;
      int width = 0, height = 0;
      if (const auto video = m_videoSizes.find(first->video.value); first->video && video != m_videoSizes.end())
        std::tie(width, height) = video->second;
      else if (const auto header = first->image.path.empty() ? Result<PictureHeader>(PictureHeader{}) : readPictureHeader(first->image.path))
        width = header->width, height = header->height;
      if (width == 0 || (width == camera.camera.width() && height == camera.camera.height())) continue;
      m_outcome.notes.push_back(fmt::format("The picture {} has {}×{} pixels, its calibration '{}' is for {}×{}. Use the calibration of this picture size",
                                            first->name, width, height, camera.name, camera.camera.width(), camera.camera.height()));
    }
  }

  Progress m_progress;
  std::map<std::int64_t, std::pair<int, int>> m_videoSizes;
  NewProjectOutcome m_outcome;
  std::vector<CameraSource> m_cameras;
  std::int64_t m_nextFrame = 0;
};

}  // namespace

Result<NewProjectOutcome> newProject(const NewProjectInputs& inputs, const Progress& progress) {
  Assembler assembler(Project{}, progress);
  const auto each = [&](const std::vector<std::string>& paths, const auto& add) -> Result<void> {
    for (const auto& path : paths) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(0.0, "Looking at " + std::filesystem::path(path).filename().string());
      if (auto done = add(path); !done) return fail(done.error());
    }
    return {};
  };
  using Path = const std::string&;
  if (auto r = each(inputs.scans, [&](Path p) {
        return inputs.scansAlone ? assembler.addScan(p) : assembler.addScanWithPictures(p, true);
      }); !r) return fail(r.error());
  if (auto r = each(inputs.designs, [&](Path p) { return assembler.addDesign(p); }); !r) return fail(r.error());
  if (auto r = each(inputs.images, [&](Path p) { return assembler.addPictures(p); }); !r) return fail(r.error());
  if (auto r = each(inputs.videos, [&](Path p) { return assembler.addPictures(p); }); !r) return fail(r.error());
  if (auto r = each(inputs.rigs, [&](Path p) { return assembler.addRig(p); }); !r) return fail(r.error());
  if (auto r = each(inputs.cameras, [&](Path p) { return assembler.addCameras(p); }); !r) return fail(r.error());
  if (auto r = each(inputs.stakePoints, [&](Path p) { return assembler.addPoints(p, false); }); !r) return fail(r.error());
  if (auto r = each(inputs.controlPoints, [&](Path p) { return assembler.addPoints(p, true); }); !r) return fail(r.error());
  NewProjectOutcome outcome = assembler.finish();
  if (!outcome.project.scans.empty()) outcome.project.name = outcome.project.scans.front().name;
  else if (!outcome.project.designs.empty()) outcome.project.name = outcome.project.designs.front().name;
  else outcome.project.name = "Untitled";
  return outcome;
}

Result<NewProjectOutcome> addToProject(const Project& project, const std::vector<std::string>& paths,
                                       const Progress& progress) {
  Assembler assembler(project, progress);
  for (const auto& path : paths) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(0.0, "Looking at " + std::filesystem::path(path).filename().string());
    if (auto done = assembler.addAnything(path); !done) return fail(done.error());
  }
  NewProjectOutcome outcome = assembler.finish();
  Project& made = outcome.project;
  if (made.name.empty()) {
    if (!made.scans.empty()) made.name = made.scans.front().name;
    else if (!made.designs.empty()) made.name = made.designs.front().name;
    else made.name = "Untitled";
  }
  return outcome;
}

Result<void> encodeVideo(const std::vector<std::string>& pictures, const std::string& path, double framesPerSecond,
                         const Progress& progress) {
  std::optional<VideoWriter> writer;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(static_cast<double>(i) / static_cast<double>(pictures.size()), "Writing the video");
    const auto picture = readPicture(pictures[i]);
    if (!picture) return fail(picture.error());
    if (!writer) {
      auto made = VideoWriter::create(path, picture->width(), picture->height(), framesPerSecond);
      if (!made) return fail(made.error());
      writer.emplace(std::move(*made));
    }
    if (auto written = writer->write(*picture); !written) return written;
  }
  if (!writer) return fail("There are no pictures to make a video of", path, "Give pictures");
  return writer->finish();
}

Result<std::string> makeDemo(const std::string& folder, const DemoOptions& options, const Progress& progress, bool asVideo) {
  auto site = writeDemoSite(folder, options, progress.part(0.0, asVideo ? 0.9 : 0.95));
  if (!site) return fail(site.error());
  NewProjectInputs inputs;
  inputs.scans = {site->scan};
  inputs.designs = {site->design};
  inputs.stakePoints = {site->stakePoints};
  inputs.controlPoints = {site->controlPoints};
  if (asVideo) {
    std::vector<std::string> pictures;
    for (int i = 0; i < site->frameCount; ++i) pictures.push_back((std::filesystem::path(site->images) / frameFileName(i)).string());
    const std::string video = (std::filesystem::path(folder) / "video.mp4").string();
    if (auto written = encodeVideo(pictures, video, kFramesPerSecond, progress.part(0.9, 0.95)); !written) return fail(written.error());
    inputs.videos = {video};
    inputs.cameras = {site->calibration, site->trajectory};
  } else {
    inputs.images = {site->images};
    inputs.cameras = {site->cameras};
  }
  auto made = newProject(inputs, progress.part(0.95, 1.0));
  if (!made) return fail(made.error());
  made->project.name = "Sample inspection";
  for (CameraRecord& camera : made->project.cameras) camera.readoutSecs = options.readoutSecs;
  const std::string path = (std::filesystem::path(folder) / "demo.alidade").string();
  if (auto saved = saveProject(made->project, path); !saved) return fail(saved.error());
  return path;
}

}  // namespace alidade
