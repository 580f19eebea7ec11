// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/auto_align.h"

#include <algorithm>
#include <set>

#include "app/pose_clock.h"

namespace alidade {

namespace {

AlignmentScene designedScene(const Project& project, const LoadedData& data) {
  AlignmentScene scene;
  scene.complete = true;
  for (const Design& design : project.designs) {
    const auto model = data.designs.find(design.id);
    if (!design.visible || model == data.designs.end()) continue;
    const std::set<std::string> hidden(design.hiddenElements.begin(), design.hiddenElements.end());
    scene.surfaces.push_back(std::make_shared<const OccluderMesh>(occluderMeshOf(*model->second, hidden)));
  }
  return scene;
}

}  // namespace

AlignTo alignmentTarget(const Project& project) {
  const bool hasScan = std::any_of(project.scans.begin(), project.scans.end(), [](const Scan& scan) { return scan.visible; });
  return hasScan ? AlignTo::Scans : AlignTo::Designs;
}

AlignmentScene alignmentScene(const Project& project, const LoadedData& data, AlignTo to) {
  if (to == AlignTo::Designs) return designedScene(project, data);
  AlignmentScene scene;
  for (const Scan& scan : project.scans) {
    const auto layers = data.scans.find(scan.id);
    if (!scan.visible || layers == data.scans.end()) continue;
    for (const ScanLayer& layer : layers->second) {
      scene.scans.push_back(layer.points.store);
      if (layer.surface) scene.surfaces.push_back(layer.surface);
    }
  }
  return scene;
}

Result<AlignmentSummary> autoAlignFrame(Project& project, const AlignmentScene& scene, PictureCache& pictures, FrameId frameId,
                                        const AlignmentOptions& options, bool dryRun, const Progress& progress) {
  Frame* frame = project.findFrame(frameId);
  if (!frame) return fail("The project holds no such frame", project.path);
  const CameraRecord* camera = project.findCamera(frame->camera);
  if (!camera) return fail("Frame '" + frame->name + "' has no camera", project.path, "Add a calibration first");
  if (!frame->cameraFromWorld)
    return fail("Frame '" + frame->name + "' has no pose to start from", project.path,
                "Give it one to 3° and 0.3 m: poses from a file, or a resection from picked points");
  const auto picture = pictures.picture(project, *frame);
  if (!picture) return fail(picture.error());
  AlignmentOptions asRead = options;
  asRead.shutter = shutterOf(project, *frame);
  auto summary = alignPicture(scene, **picture, camera->camera, *frame->cameraFromWorld, asRead, progress);
  if (!summary) return fail(summary.error().in("frame '" + frame->name + "'"));
  if (!summary->converged || dryRun) return summary;

  if (!frame->originalCameraFromWorld) frame->originalCameraFromWorld = frame->cameraFromWorld;
  frame->cameraFromWorld = summary->cameraFromWorld;
  frame->poseSource = PoseSource::Refined;
  PoseQuality quality;
  quality.rmsPx = summary->estimate.rmsPx * summary->levelScale;
  quality.sigma0 = summary->estimate.sigma0;
  quality.positionStdM = summary->estimate.positionStdM;
  quality.rotationStdRad = summary->estimate.rotationStdRad;
  quality.observations = static_cast<int>(summary->places.size());
  frame->quality = quality;
  return summary;
}

}  // namespace alidade
