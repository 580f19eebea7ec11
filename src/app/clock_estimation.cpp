// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/clock_estimation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/feature_tracks.h"

namespace alidade {

namespace {

/// How far a picture should move between the two of a pair, pixels of its width: enough to tell, little enough to follow.
constexpr double kWantedFlow = 0.015;
constexpr int kFarthestApart = 8;  // frames

double medianFlow(const std::vector<std::pair<glm::dvec2, glm::dvec2>>& tracks) {
  if (tracks.empty()) return 0;
  std::vector<double> lengths;
  for (const auto& [a, b] : tracks) lengths.push_back(glm::length(b - a));
  std::nth_element(lengths.begin(), lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2), lengths.end());
  return lengths[lengths.size() / 2];
}

}  // namespace

Result<ClockOffset> estimateClock(const Project& project, TrajectoryId id, const ClockEstimationOptions& options,
                                  PictureCache& pictures, const Progress& progress) {
  const Trajectory* trajectory = project.findTrajectory(id);
  if (!trajectory) return fail("The project has no such trajectory", project.path, "Add one: a TUM or EuRoC file of timed poses");
  std::vector<const Frame*> frames;
  const CameraRecord* camera = nullptr;
  for (const Frame& frame : project.frames) {
    if (frame.trajectory != id) continue;
    const CameraRecord* its = project.findCamera(frame.camera);
    if (!its)
      return fail("Frame '" + frame.name + "' has no camera", project.path, "Add a calibration: what moves in a picture tells nothing without its lens");
    if (camera && its != camera)
      return fail("The trajectory serves pictures of two cameras", project.path, "Keep a trajectory a camera, as a rig file does");
    camera = its;
    frames.push_back(&frame);
  }
  if (frames.size() < 2) return fail("The trajectory serves fewer than two frames", project.path, "Add the video that it belongs to");

  const auto count = static_cast<std::ptrdiff_t>(frames.size());
  const auto wanted = std::min<std::ptrdiff_t>(options.atMostPairs, count - 1);
  std::vector<TrackedPair> pairs;
  int apart = 1;
  for (std::ptrdiff_t i = 0; i < wanted; ++i) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(0.9 * static_cast<double>(i) / static_cast<double>(wanted), "Following what moves in the pictures");
    const std::ptrdiff_t at = i * (count - 1) / wanted;
    const auto first = pictures.picture(project, *frames[static_cast<std::size_t>(at)]);
    if (!first) return fail(first.error());
    const std::ptrdiff_t next = std::min(at + apart, count - 1);
    const auto second = pictures.picture(project, *frames[static_cast<std::size_t>(next)]);
    if (!second) return fail(second.error());
    if ((*first)->width() != camera->camera.width() || (*first)->height() != camera->camera.height())
      return fail(fmt::format("The picture is {} × {} px, its camera is calibrated for {} × {}", (*first)->width(), (*first)->height(),
                              camera->camera.width(), camera->camera.height()),
                  frames[static_cast<std::size_t>(at)]->name, "Use the calibration that belongs to this picture");
    auto tracks = trackFeatures(**first, **second);
    if (!tracks) return fail(tracks.error());
    // The next pair as far apart as this one's movement asks for.
    const double flow = medianFlow(*tracks), wantedFlow = kWantedFlow * (*first)->width();
    if (tracks->size() < 20 || flow > 4 * wantedFlow) apart = std::max(1, apart / 2);
    else if (flow < 0.5 * wantedFlow) apart = std::min(kFarthestApart, apart + 1);
    pairs.push_back({frames[static_cast<std::size_t>(at)]->timeSecs, frames[static_cast<std::size_t>(next)]->timeSecs, std::move(*tracks)});
  }
  ClockOffsetOptions search = options.search;
  search.startSecs = trajectory->clockOffsetSecs;
  search.readoutSecs = camera->readoutSecs;
  return estimateClockOffset(pairs, camera->camera, trajectory->track, search, progress.part(0.9, 1));
}

}  // namespace alidade
