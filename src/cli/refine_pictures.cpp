// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cli/refine_pictures.h"

#include <cmath>

#include <fmt/format.h>

#include "app/auto_align.h"
#include "app/refine_sequence.h"
#include "cli/refine_json.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const std::string& frame, const AlignmentSummary& summary, const std::vector<ExpectedError>& expected) {
  const AlignmentEvidence& e = summary.evidence;
  Json json = {{"frame", frame}, {"converged", summary.converged}, {"reason", summary.reason}, {"confidence", summary.confidence}};
  json["evidence"] = {{"places_sought", e.patches}, {"places_found", e.matched}, {"places_agreeing", e.inliers},
                      {"correlation", e.correlation}, {"spread", e.spread}, {"expected_error_px", e.expectedPx},
                      {"halves_px", e.halvesPx}, {"information_distance", e.information},
                      {"information_distance_aside", e.informationAside}, {"rival_score", e.rivalScore}, {"aside_score", e.asideScore}};
  if (!summary.converged) return json;
  const glm::dquat& q = summary.cameraFromWorld.rotation;
  json["camera_centre_m"] = vec(summary.cameraFromWorld.centre());
  json["camera_from_world_wxyz"] = {q.w, q.x, q.y, q.z};
  json["sigma0"] = summary.estimate.sigma0;
  json["position_std_m"] = vec(summary.estimate.positionStdM);
  json["rotation_std_rad"] = vec(summary.estimate.rotationStdRad);
  json["ellipse_95"] = ellipseOf(positionEllipse(summary.estimate.covariance));
  json["expected_error_mm"] = expectedOf(expected);
  json["moved_m"] = vec(summary.cameraFromWorld.centre() - summary.startCameraFromWorld.centre());
  json["turned_rad"] = rotationAngleBetween(summary.cameraFromWorld, summary.startCameraFromWorld);
  return json;
}

}  // namespace

void addMotion(const Project& project, const Network& network, const NetworkClocks& clocks, const NetworkSummary& summary, Json& json) {
  Json mounts = Json::array(), offsets = Json::array();
  for (std::size_t i = 0; i < network.mounts.size(); ++i) {
    const RigidTransform cameraFromBody = i < summary.cameraFromBody.size() ? summary.cameraFromBody[i] : network.mounts[i].cameraFromBody;
    const glm::dquat q = glm::conjugate(cameraFromBody.rotation);
    Json mount = {{"camera", network.mounts[i].name}, {"position_on_body_m", vec(cameraFromBody.centre())},
                  {"body_from_camera_wxyz", {q.w, q.x, q.y, q.z}}, {"free", !network.mounts[i].locked[0]}};
    if (i < summary.mountAccuracy.size())
      mount["offset_std_m"] = vec(summary.mountAccuracy[i].offsetStdM), mount["rotation_std_rad"] = vec(summary.mountAccuracy[i].rotationStdRad);
    mounts.push_back(std::move(mount));
  }
  for (std::size_t i = 0; i < clocks.size() && i < summary.clockOffsetSecs.size(); ++i)
    for (const TrajectoryId& id : clocks[i])
      offsets.push_back({{"trajectory", project.findTrajectory(id)->name}, {"offset_s", summary.clockOffsetSecs[i]},
                         {"offset_std_s", summary.clockStdSecs[i]}, {"free", network.trajectories[i].clockFree}});
  json["mounts"] = std::move(mounts), json["clocks"] = std::move(offsets);
}

Result<Answer> refineAutomatically(const RefinePictures& wanted, const Progress& progress) {
  auto project = loadProject(wanted.project);
  if (!project) return fail(project.error());
  std::vector<FrameId> frames;
  if (!wanted.frame.empty()) {
    const auto frame = project->frameByNameOrIndex(wanted.frame);
    if (!frame) return fail(frame.error());
    frames.push_back(*frame);
  } else {
    for (const Frame& frame : project->frames) frames.push_back(frame.id);
  }
  if (frames.empty()) return fail("The project has no frame to align", wanted.project, "Add pictures and approximate poses");
  auto loaded = loadData(*project, progress.part(0, 0.1));
  if (!loaded) return fail(loaded.error());
  const AlignmentScene scene = alignmentScene(*project, loaded->data, wanted.to.value_or(alignmentTarget(*project)));
  PictureCache pictures;
  Answer answer;
  Json list = Json::array();
  int converged = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string name = project->findFrame(frames[i])->name;
    const double from = 0.1 + 0.9 * static_cast<double>(i) / static_cast<double>(frames.size());
    const auto summary = autoAlignFrame(*project, scene, pictures, frames[i], wanted.options, wanted.dryRun,
                                        progress.part(from, from + 0.9 / static_cast<double>(frames.size())));
    if (!summary) {
      // One frame was asked for, or the job was cancelled: that is the answer. One of many is told among the others.
      if (frames.size() == 1 || isCancelled(summary.error())) return fail(summary.error());
      list.push_back({{"frame", name}, {"converged", false}, {"reason", summary.error().text()}, {"confidence", 0.0}});
      answer.text += fmt::format("{}: {}\n", name, summary.error().text());
      continue;
    }
    if (summary->converged) ++converged;
    const Camera& camera = project->findCamera(project->findFrame(frames[i])->camera)->camera;
    std::vector<ExpectedError> expected;
    for (const glm::dvec3& point : wanted.at)
      expected.push_back(expectedError(camera, summary->cameraFromWorld, summary->estimate.covariance, point));
    list.push_back(jsonOf(name, *summary, expected));
    answer.text += frames.size() == 1 ? summary->report()
                                      : fmt::format("{}: {}\n", name,
                                                    summary->converged ? fmt::format("converged, confidence {:.0f} %, expected error {:.2f} px",
                                                                                     100 * summary->confidence, summary->evidence.expectedPx)
                                                                       : "not converged: " + summary->reason);
  }
  const bool save = converged > 0 && !wanted.dryRun;
  if (save)
    if (auto saved = saveProject(*project, wanted.project); !saved) return fail(saved.error());
  answer.json = {{"frames", std::move(list)}, {"converged", converged}, {"saved", save}};
  answer.failed = converged == 0;
  return answer;
}

Result<Answer> refineTogether(const RefinePictures& wanted, const Progress& progress) {
  auto project = loadProject(wanted.project);
  if (!project) return fail(project.error());
  auto loaded = loadData(*project, progress.part(0, 0.1));
  if (!loaded) return fail(loaded.error());
  PictureCache pictures;
  SequenceOptions options;
  options.alignment = wanted.options, options.everyNth = wanted.keyframes, options.ties = wanted.ties, options.at = wanted.at;
  const auto summary = refineSequence(*project, alignmentScene(*project, loaded->data, wanted.to.value_or(alignmentTarget(*project))), pictures, options, wanted.dryRun, progress.part(0.1, 1));
  if (!summary) return fail(summary.error());
  const bool save = summary->converged && !wanted.dryRun;
  if (save)
    if (auto saved = saveProject(*project, wanted.project); !saved) return fail(saved.error());
  Json frames = Json::array(), alarms = Json::array(), groups = Json::array();
  for (std::size_t i = 0; i < summary->frames.size(); ++i) {
    const SequenceFrame& f = summary->frames[i];
    const glm::dquat& q = f.after.rotation;
    Json frame = {{"frame", project->findFrame(f.frame)->name}, {"refined", f.refined}, {"aligned", f.aligned}, {"reason", f.reason},
                  {"camera_centre_m", vec(f.after.centre())}, {"camera_from_world_wxyz", {q.w, q.x, q.y, q.z}},
                  {"moved_m", glm::distance(f.before.centre(), f.after.centre())}, {"turned_rad", rotationAngleBetween(f.before, f.after)}};
    if (f.refined) {
      const AdjustedPose& pose = summary->poseOf(i);
      frame["position_std_m"] = vec(pose.positionStdM), frame["rotation_std_rad"] = vec(pose.rotationStdRad);
      frame["ellipse_95"] = ellipseOf(pose.ellipse), frame["expected_error_mm"] = expectedOf(summary->expectedIn(i));
    }
    frames.push_back(std::move(frame));
  }
  for (const MovementAlarm& alarm : summary->alarms)
    alarms.push_back({{"frame", project->findFrame(alarm.frame)->name}, {"moved_m", alarm.metres}, {"turned_rad", alarm.radians}, {"moved_px", alarm.pixels}});
  for (const ResidualGroup& g : summary->adjustment.groups)
    groups.push_back({{"kind", residualKindName(g.kind)}, {"held_out", g.heldOut}, {"count", g.count}, {"outliers", g.outliers},
                      {"rms_px", std::isfinite(g.rmsPx) ? Json(g.rmsPx) : Json(nullptr)}, {"rms_sigmas", g.rmsSigmas}});
  Answer answer;
  answer.json = {{"converged", summary->converged}, {"reason", summary->reason}, {"sigma0", summary->adjustment.sigma0},
                 {"frames", std::move(frames)}, {"movement", std::move(alarms)}, {"groups", std::move(groups)}};
  addMotion(*project, summary->network, summary->clocks, summary->adjustment, answer.json);
  answer.json["saved"] = save;
  answer.text = summary->report(*project);
  answer.failed = !summary->converged;
  return answer;
}

}  // namespace alidade::cli
