// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/start_pose.h"
#include "app/jobs.h"
#include "app/observation_rows.h"
#include "app/pose_clock.h"
#include "plugin_api/picture_header.h"

namespace alidade {

Result<std::vector<ResectionObservation>> readObservations(const std::string& path) {
  const auto rows = readObservationRows(path);
  if (!rows) return fail(rows.error());
  std::vector<ResectionObservation> observations;
  for (const ObservationRow& row : *rows) {
    if ((row.kind != ObservationKind::Control && row.kind != ObservationKind::Scan) || row.heldOut)
      return fail("Only control and scan points refine a single frame", row.where, "Adjust them as a network");
    observations.push_back({row.pixel, *row.world, row.sigmaPx, row.name, row.sigmaM});
  }
  return observations;
}

Result<ResectionSummary> refineFrame(Project& project, FrameId frameId,
                                     const std::vector<ResectionObservation>& observations,
                                     const ResectionOptions& options, bool dryRun) {
  Frame* frame = project.findFrame(frameId);
  if (!frame) return fail("The project holds no such frame", project.path);
  const CameraRecord* camera = project.findCamera(frame->camera);
  if (!camera) return fail("Frame '" + frame->name + "' has no camera", project.path, "Add a calibration first");
  const auto header = frame->image.path.empty() ? Result<PictureHeader>(PictureHeader{}) : readPictureHeader(frame->image.path);
  if (header && header->width > 0 && (header->width != camera->camera.width() || header->height != camera->camera.height()))
    return fail("The picture has " + std::to_string(header->width) + "×" + std::to_string(header->height) +
                    " pixels, its calibration is for " + std::to_string(camera->camera.width()) + "×" +
                    std::to_string(camera->camera.height()),
                frame->image.path, "Use the calibration of this picture size");
  ResectionOptions asRead = options;
  asRead.shutter = shutterOf(project, *frame);
  std::optional<RigidTransform> start = frame->cameraFromWorld;
  if (!start) {
    const auto found = findStartPose(camera->camera, observations, asRead.shutter);
    if (!found)
      return fail("Frame '" + frame->name + "' has no pose to start from: " + found.error().what, project.path, found.error().advice);
    start = *found;
  }
  auto summary = resect(camera->camera, *start, observations, asRead);
  if (!summary || !summary->converged || dryRun) return summary;

  if (!frame->originalCameraFromWorld) frame->originalCameraFromWorld = frame->cameraFromWorld;
  frame->cameraFromWorld = summary->cameraFromWorld;
  frame->poseSource = PoseSource::Refined;
  PoseQuality quality;
  quality.rmsPx = summary->rmsPx;
  quality.sigma0 = summary->sigma0;
  quality.positionStdM = summary->positionStdM;
  quality.rotationStdRad = summary->rotationStdRad;
  quality.observations = static_cast<int>(observations.size()) - summary->outlierCount();
  frame->quality = quality;
  return summary;
}

}  // namespace alidade
