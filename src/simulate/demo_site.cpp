// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "simulate/demo_site.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "camera/rolling_shutter.h"
#include "simulate/camera_path.h"
#include "simulate/design_writer.h"
#include "simulate/frame_renderer.h"
#include "simulate/output_file.h"
#include "simulate/png_file.h"
#include "simulate/point_lists.h"
#include "simulate/pose_writer.h"
#include "simulate/scanner.h"
#include "simulate/site_model.h"
#include "simulate/truth_writer.h"

namespace alidade {

namespace {

constexpr double kObservationNoisePx = 0.3;
/// Depth and visibility are kept of about this many frames at most.
constexpr int kTruthFrames = 50;
constexpr double kPosesPerSecond = 60, kTrackedAround = 0.5;

/// Runs the steps of one site, each after the other, and remembers what they share.
class DemoWriter {
 public:
  DemoWriter(const std::string& folder, const DemoOptions& options, const Progress& progress)
      : m_options(options), m_progress(progress) {
    m_demo.scan = folder + "/scan.las";
    m_demo.stations = folder + "/scan.stations.json";
    m_demo.images = folder + "/images";
    m_demo.cameras = folder + "/sparse";
    m_demo.perturbedCameras = folder + "/sparse_perturbed";
    m_demo.trajectory = folder + "/trajectory.txt";
    m_demo.calibration = folder + "/camera.yml";
    m_demo.design = folder + "/design.ifc";
    m_demo.designMesh = folder + "/design.obj";
    m_demo.stakePoints = folder + "/stake.csv";
    m_demo.controlPoints = folder + "/control.csv";
    m_demo.observations = folder + "/observations.csv";
    if (options.truth) m_demo.truth = folder + "/truth";
  }

  Result<DemoSite> run() {
    m_progress.report(0.0, "Building the site");
    m_site = makeSite(m_options.seed, m_options.siteOrigin);
    if (auto written = writeDesign(); !written) return fail(written.error());
    const auto built = RayScene::make(m_site.asBuilt);
    if (!built) return fail(built.error());
    const auto design = RayScene::make(m_site.design);
    if (!design) return fail(design.error());
    const Lighting lighting(*built);
    if (auto written = writePoses(*built); !written) return fail(written.error());
    if (auto written = writeVideo(*built, *design, lighting); !written) return fail(written.error());
    const auto scan = writeScan(m_demo.scan, m_site, *built, lighting, m_truth.scanner, m_options.points,
                                m_options.seed, true, m_progress.part(videoShare(), 0.99));
    if (!scan) return fail(scan.error());
    m_truth.scan = *scan;
    m_demo.pointCount = scan->points;
    m_demo.frameCount = m_options.frames;
    if (auto written = writeStations(m_demo.stations, *scan); !written) return fail(written.error());
    if (m_options.truth)
      if (auto written = writeTruth(m_demo.truth + "/truth.json", m_truth); !written)
        return fail(written.error());
    m_progress.report(1.0, "Demo site written");
    return m_demo;
  }

 private:
  /// The video's part of the whole time, from what a pixel and a point cost.
  double videoShare() const {
    const double video = 1.2e-6 * m_options.frames * m_options.width * m_options.height;
    const double scan = 1.0e-6 * static_cast<double>(m_options.points);
    return 0.05 + 0.94 * video / (video + scan + 1e-9);
  }

  Result<void> writeDesign() {
    for (const std::string& folder : {m_demo.images, m_demo.cameras, m_demo.perturbedCameras, m_demo.truth})
      if (!folder.empty())
        if (auto made = makeFolder(folder); !made) return made;
    if (auto written = writeDesignIfc(m_demo.design, m_site); !written) return written;
    if (auto written = writeDesignObj(m_demo.designMesh, m_site); !written) return written;
    if (auto written = writeStakePoints(m_demo.stakePoints, m_site); !written) return written;
    return writeControlPoints(m_demo.controlPoints, m_site);
  }

  Result<void> writePoses(const RayScene& built) {
    m_truth.site = &m_site;
    m_truth.options = &m_options;
    m_truth.intrinsics = demoIntrinsics(m_options.width, m_options.height);
    m_truth.truthEvery = std::max(1, (m_options.frames + kTruthFrames - 1) / kTruthFrames);
    const RigidTransform siteFromWorld = m_site.worldFromSite.inverse();
    m_cameraFromSite = walkPast(m_options.frames, m_options.seed);
    for (const RigidTransform& pose : m_cameraFromSite)
      m_truth.cameraFromWorld.push_back(pose * siteFromWorld);
    if (auto written = writeColmapModel(m_demo.cameras, m_truth.intrinsics, m_truth.cameraFromWorld);
        !written)
      return written;
    const auto wrong = perturbed(m_truth.cameraFromWorld, m_options.seed);
    if (auto written = writeColmapModel(m_demo.perturbedCameras, m_truth.intrinsics, wrong); !written)
      return written;
    if (auto written = writeTracked(siteFromWorld); !written) return written;
    if (auto written = writeCalibration(m_demo.calibration, m_truth.intrinsics); !written) return written;
    if (!m_cameraFromSite.empty())
      m_truth.controlInFirstFrame =
          seenControlPoints(m_site, built, Camera(m_truth.intrinsics), m_cameraFromSite.front());
    return writeObservations(m_demo.observations, m_site, m_truth.controlInFirstFrame, kObservationNoisePx,
                             m_options.seed);
  }

  /// What a tracker gives: more poses than frames, from half a second before the first to half a second after the last.
  Result<void> writeTracked(const RigidTransform& siteFromWorld) {
    const Walk walk(m_options.seed);
    std::vector<RigidTransform> poses;
    const double end = (m_options.frames - 1) / kFramesPerSecond + kTrackedAround;
    for (int i = 0; i / kPosesPerSecond <= end + kTrackedAround; ++i)
      poses.push_back(walk.at(i / kPosesPerSecond - kTrackedAround) * siteFromWorld);
    return writeTrajectory(m_demo.trajectory, poses, kPosesPerSecond, m_options.clockOffsetSecs - kTrackedAround);
  }

  /// cameraFromSite of one frame, or of each of its rows.
  std::vector<RigidTransform> posesOf(int frame) const {
    if (m_options.readoutSecs == 0) return {m_cameraFromSite[frame]};
    const Walk walk(m_options.seed);
    const RollingShutter shutter{m_options.readoutSecs, {}};
    std::vector<RigidTransform> rows;
    for (int y = 0; y < m_options.height; ++y)
      rows.push_back(walk.at(frame / kFramesPerSecond + shutter.secsAtRow(y, m_options.height)));
    return rows;
  }

  Result<void> writeVideo(const RayScene& built, const RayScene& design, const Lighting& lighting) {
    const FrameRenderer renderer(Camera(m_truth.intrinsics), built, design, lighting, m_options.seed,
                                 m_options.colour);
    const Progress progress = m_progress.part(0.05, videoShare());
    for (int frame = 0; frame < m_options.frames; ++frame) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(static_cast<double>(frame) / m_options.frames,
                      fmt::format("Filming frame {} of {}", frame + 1, m_options.frames));
      FrameTruth truth;
      const ColourImage picture = renderer.render(posesOf(frame), frame, truth);
      if (auto written = writePng(m_demo.images + "/" + frameFileName(frame), picture, m_options.colour);
          !written)
        return written;
      if (m_options.truth && frame % m_truth.truthEvery == 0)
        if (auto written = writeFrameTruth(m_demo.truth, frame, truth); !written) return written;
    }
    return {};
  }

  const DemoOptions m_options;
  const Progress m_progress;
  DemoSite m_demo;
  SiteModel m_site;
  DemoTruth m_truth;
  std::vector<RigidTransform> m_cameraFromSite;
};

}  // namespace

Result<void> DemoOptions::validate() const {
  const auto wrong = [](const std::string& what, const std::string& advice) {
    return fail(what, "demo options", advice);
  };
  if (points < 100 || points > 10'000'000'000ull)
    return wrong(fmt::format("The scan cannot have {} points", points),
                 "Ask for 100 to 10 000 000 000 points");
  if (frames < 0 || frames > 9999)
    return wrong(fmt::format("The video cannot have {} frames", frames), "Ask for 0 to 9999 frames");
  if (width < 16 || height < 16 || width > 8192 || height > 8192)
    return wrong(fmt::format("The video cannot be {} by {} pixels", width, height),
                 "Ask for 16 to 8192 pixels a side");
  if (!std::isfinite(clockOffsetSecs) || std::abs(clockOffsetSecs) > 1e10 || !(std::abs(readoutSecs) <= 0.06))
    return wrong("The camera's clock or shutter is none", "Give a clock offset in seconds and a read-out of at most 0.06 s");
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(siteOrigin[axis]) || std::abs(siteOrigin[axis]) > 2e7)
      return wrong("The site's origin is no place on a map grid", "Give coordinates within 20 000 km");
  return {};
}

Result<DemoSite> writeDemoSite(const std::string& folder, const DemoOptions& options,
                               const Progress& progress) {
  if (auto valid = options.validate(); !valid) return fail(valid.error());
  if (auto made = makeFolder(folder); !made) return fail(made.error());
  std::error_code code;
  const std::filesystem::path absolute = std::filesystem::absolute(folder, code);
  if (code) return fail("The folder cannot be found: " + code.message(), folder);
  return DemoWriter(absolute.lexically_normal().string(), options, progress).run();
}

}  // namespace alidade
