// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "app/jobs.h"
#include "app/refine_network.h"
#include "cli/command.h"
#include "cli/refine_json.h"
#include "cli/refine_pictures.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string project, frame, observations, lock, free;
  std::vector<std::string> at;
  bool dryRun = false, keep = false, automatic = false, sequence = false, rig = false, trajectory = false;
  double withinPx = 1;
  std::optional<AlignTo> to;
  int keyframes = 1;
};

/// What is free beyond the poses.
Result<void> applyFree(const std::string& list, NetworkFreedom& freedom) {
  std::size_t start = 0;
  while (!list.empty() && start <= list.size()) {
    const auto comma = std::min(list.find(',', start), list.size());
    const std::string name = list.substr(start, comma - start);
    if (name == "focal") freedom.focal = true;
    else if (name == "principal-point") freedom.principalPoint = true;
    else if (name == "distortion") freedom.distortion = true;
    else if (name == "rig") freedom.ties.rig = freedom.ties.freeMounts = true;
    else if (name == "clock") freedom.ties.trajectory = freedom.ties.freeClock = true;
    else return fail("'" + name + "' cannot be freed", "--free", "Free focal, principal-point, distortion, rig or clock; poses are free unless --lock names them");
    start = comma + 1;
  }
  return {};
}

Result<void> applyLocks(const std::string& list, NetworkFreedom& freedom) {
  std::size_t start = 0;
  while (!list.empty() && start <= list.size()) {
    const auto comma = std::min(list.find(',', start), list.size());
    const std::string name = list.substr(start, comma - start);
    if (name == "position") freedom.lockPosition.fill(true);
    else if (name == "attitude") freedom.lockAttitude.fill(true);
    else if (name == "x" || name == "e") freedom.lockPosition[0] = true;
    else if (name == "y" || name == "n") freedom.lockPosition[1] = true;
    else if (name == "z" || name == "h") freedom.lockPosition[2] = true;
    else if (name == "rx") freedom.lockAttitude[0] = true;
    else if (name == "ry") freedom.lockAttitude[1] = true;
    else if (name == "rz") freedom.lockAttitude[2] = true;
    else return fail("'" + name + "' cannot be locked", "--lock", "Lock position, attitude, one of x, y, z, or one rotation of rx, ry, rz");
    start = comma + 1;
  }
  return {};
}

Result<glm::dvec3> parsePoint(const std::string& text) {
  glm::dvec3 p{0};
  char tail = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &p.x, &p.y, &p.z, &tail) != 3 || !std::isfinite(p.x + p.y + p.z))
    return fail("'" + text + "' is no point", "--at", "Give E,N,H in metres");
  return p;
}

/// The parameters by name, and those that were free with their standard deviations and correlations.
Json calibrationOf(const Network& network, const NetworkSummary& summary, std::size_t camera) {
  const Intrinsics& lens = summary.cameras[camera];
  const auto names = parameterNames(lens.model);
  const auto values = lens.parameters();
  Json json = {{"name", network.cameras[camera].name}, {"model", cameraModelName(lens.model)}, {"parameters", values}, {"parameter_names", names}};
  if (camera >= summary.cameraAccuracy.size() || summary.cameraAccuracy[camera].covariance.empty()) return json;
  const CameraAccuracy& accuracy = summary.cameraAccuracy[camera];
  Json std = Json::array(), correlation = Json::array();
  const int count = static_cast<int>(names.size());
  for (int a = 0; a < count; ++a) {
    std.push_back(accuracy.std(a));
    Json row = Json::array();
    for (int b = 0; b < count; ++b) row.push_back(accuracy.correlation(a, b));
    correlation.push_back(std::move(row));
  }
  json["parameter_std"] = std::move(std), json["correlation"] = std::move(correlation);
  return json;
}

Json jsonOf(const Project& project, const NetworkRefinement& refinement, const NetworkSummary& summary, bool dryRun) {
  const Network& network = refinement.network;
  Json json = {{"converged", summary.converged}, {"reason", summary.reason}, {"iterations", summary.iterations},
               {"initial_cost", summary.initialCost}, {"final_cost", summary.finalCost}, {"sigma0", summary.sigma0},
               {"sigma_scale", summary.sigmaScale}, {"redundancy", summary.redundancy}};
  Json frames = Json::array(), groups = Json::array(), residuals = Json::array(), outliers = Json::array(), checks = Json::array();
  for (std::size_t i = 0; i < network.frames.size(); ++i) {
    const AdjustedPose& pose = summary.poses[network.frames[i].pose];
    // Not converged, the summary has no mounts.
    const RigidTransform camera = summary.converged ? cameraFromWorld(network, summary, static_cast<int>(i)) : pose.bodyFromWorld;
    const glm::dquat& q = camera.rotation;
    frames.push_back({{"name", network.frames[i].name}, {"camera_centre_m", vec(camera.centre())},
                      {"camera_from_world_wxyz", {q.w, q.x, q.y, q.z}}, {"position_std_m", vec(pose.positionStdM)},
                      {"rotation_std_rad", vec(pose.rotationStdRad)}, {"ellipse_95", ellipseOf(pose.ellipse)},
                      {"rms_px", pose.rmsPx}, {"observations", pose.observations}, {"outliers", pose.outliers}});
  }
  for (const ResidualGroup& g : summary.groups)
    groups.push_back({{"kind", residualKindName(g.kind)}, {"held_out", g.heldOut}, {"count", g.count}, {"outliers", g.outliers},
                      {"rms_px", finite(g.rmsPx)}, {"rms_m", finite(g.rmsM)}, {"rms_sigmas", finite(g.rmsSigmas)}});
  for (const NetworkResidual& r : summary.residuals) {
    if (r.outlier) outliers.push_back(r.name);
    residuals.push_back({{"name", r.name}, {"frame", r.frame < 0 ? Json(nullptr) : Json(network.frames[r.frame].name)},
                         {"kind", residualKindName(r.kind)}, {"du_px", finite(r.residualPx.x)}, {"dv_px", finite(r.residualPx.y)},
                         {"residual_m", finite(r.residualM)}, {"sigmas", finite(r.sigmas)}, {"outlier", r.outlier}, {"held_out", r.heldOut}});
  }
  for (const CheckPoint& c : summary.checkPoints) checks.push_back({{"name", c.name}, {"difference_m", vec(c.differenceM)}});
  Json cameras = Json::array();
  for (std::size_t i = 0; i < summary.cameras.size(); ++i) cameras.push_back(calibrationOf(network, summary, i));
  json["frames"] = std::move(frames);
  json["cameras"] = std::move(cameras);
  json["expected_error_mm"] = expectedOf(summary.expected);
  json["groups"] = std::move(groups);
  json["check_points"] = std::move(checks);
  json["correlations"] = summary.correlations;
  json["warnings"] = summary.warnings;
  json["outliers"] = std::move(outliers);
  json["residuals"] = std::move(residuals);
  addMotion(project, network, refinement.clocks, summary, json);
  json["saved"] = summary.converged && !dryRun;
  return json;
}

Json jsonOf(const ResectionSummary& summary, bool dryRun) {
  Json json = {{"converged", summary.converged}, {"reason", summary.reason}, {"iterations", summary.iterations},
               {"rms_px", summary.rmsPx}, {"sigma0", summary.sigma0}, {"sigma_scale", summary.sigmaScale}, {"position_std_m", vec(summary.positionStdM)},
               {"rotation_std_rad", vec(summary.rotationStdRad)}};
  json["ellipse_95"] = ellipseOf(summary.ellipse);
  json["correlations"] = summary.correlations;
  json["warnings"] = summary.warnings;
  json["expected_error_mm"] = expectedOf(summary.expected);
  Json outliers = Json::array(), residuals = Json::array();
  for (const ResectionResidual& r : summary.residuals) {
    if (r.outlier) outliers.push_back(r.name);
    residuals.push_back({{"name", r.name}, {"du_px", r.residualPx.x}, {"dv_px", r.residualPx.y}, {"sigmas", r.sigmas},
                         {"outlier", r.outlier}});
  }
  json["outliers"] = std::move(outliers);
  json["residuals"] = std::move(residuals);
  const glm::dquat& q = summary.cameraFromWorld.rotation;
  json["camera_centre_m"] = vec(summary.cameraFromWorld.centre());
  json["camera_from_world_wxyz"] = {q.w, q.x, q.y, q.z};
  json["saved"] = summary.converged && !dryRun;
  return json;
}

Answer answerOf(Json json, std::string text, bool converged) {
  Answer answer;
  answer.json = std::move(json);
  answer.text = std::move(text);
  if (!answer.text.ends_with('\n')) answer.text += '\n';
  answer.failed = !converged;
  return answer;
}

/// One frame, known points and nothing else: a resection.
bool isResection(const std::vector<ObservationRow>& rows, const std::string& frame, const NetworkFreedom& freedom) {
  const auto& [rx, ry, rz] = freedom.lockAttitude;
  if (rx != ry || ry != rz) return false;
  if (frame.empty() || freedom.ties.any() || freedom.focal || freedom.principalPoint || freedom.distortion) return false;
  return std::all_of(rows.begin(), rows.end(), [&](const ObservationRow& row) {
    return (row.kind == ObservationKind::Control || row.kind == ObservationKind::Scan) && !row.heldOut &&
           (row.frame.empty() || row.frame == frame);
  });
}

/// The project's own: all, or of one frame.
Result<std::vector<ObservationRow>> rowsOf(const Project& project, const std::string& frame) {
  if (frame.empty()) return observationRowsOf(project);
  const auto only = project.frameByNameOrIndex(frame);
  if (!only) return fail(only.error());
  auto rows = observationRowsOf(project, *only);
  for (ObservationRow& row : rows) row.frame.clear();
  return rows;
}

Result<void> save(Project& project, const Arguments& arguments, const std::vector<ObservationRow>& rows) {
  if (arguments.dryRun) return {};
  if (arguments.keep)
    if (auto kept = keepObservations(project, arguments.frame, rows); !kept) return kept;
  return saveProject(project, arguments.project);
}

Result<Answer> runResection(Project& project, const Arguments& arguments, const std::vector<ObservationRow>& rows,
                            const ResectionOptions& options) {
  const auto frame = project.frameByNameOrIndex(arguments.frame);
  if (!frame) return fail(frame.error());
  // Duplicates, two positions of one name, a picture of another size: the network's rules hold for one frame as well.
  if (const auto sensible = networkOf(project, arguments.frame, rows, {}); !sensible) return fail(sensible.error());
  std::vector<ResectionObservation> observations;
  for (const ObservationRow& row : rows) observations.push_back({row.pixel, *row.world, row.sigmaPx, row.name, row.sigmaM});
  auto summary = refineFrame(project, *frame, observations, options, arguments.dryRun);
  if (!summary) return fail(summary.error());
  if (summary->converged)
    if (auto saved = save(project, arguments, rows); !saved) return fail(saved.error());
  return answerOf(jsonOf(*summary, arguments.dryRun), summary->report(), summary->converged);
}

Result<Answer> runNetwork(Project& project, const Arguments& arguments, const std::vector<ObservationRow>& rows,
                          const NetworkFreedom& freedom, const std::vector<glm::dvec3>& at, const Progress& progress) {
  const auto refinement = networkOf(project, arguments.frame, rows, freedom);
  if (!refinement) return fail(refinement.error());
  NetworkOptions options;
  for (const glm::dvec3& point : at)
    for (std::size_t f = 0; f < refinement->network.frames.size(); ++f) options.at.push_back({static_cast<int>(f), point});
  const auto summary = refineNetwork(project, *refinement, options, arguments.dryRun, progress);
  if (!summary) return fail(summary.error());
  if (summary->converged)
    if (auto saved = save(project, arguments, rows); !saved) return fail(saved.error());
  return answerOf(jsonOf(project, *refinement, *summary, arguments.dryRun), summary->report(refinement->network), summary->converged);
}

Result<Answer> runPictures(const Arguments& arguments, const ResectionOptions& resection, const MotionTies& ties, const Progress& progress) {
  RefinePictures wanted{arguments.project, arguments.frame, {}, arguments.keyframes, arguments.dryRun};
  wanted.options.lockPosition = resection.lockPosition, wanted.options.lockAttitude = resection.lockAttitude;
  wanted.options.acceptedPx = arguments.withinPx;
  wanted.to = arguments.to, wanted.ties = ties, wanted.at = resection.at;
  return arguments.sequence ? refineTogether(wanted, progress) : refineAutomatically(wanted, progress);
}

Result<Answer> run(const Arguments& arguments, const Progress& progress) {
  ResectionOptions options;
  NetworkFreedom freedom;
  if (auto done = applyLocks(arguments.lock, freedom); !done) return fail(done.error());
  if (auto done = applyFree(arguments.free, freedom); !done) return fail(done.error());
  freedom.ties.rig |= arguments.rig, freedom.ties.trajectory |= arguments.trajectory;
  options.lockPosition = freedom.lockPosition, options.lockAttitude = freedom.lockAttitude[0];
  const auto& turns = freedom.lockAttitude;
  for (const std::string& text : arguments.at) {
    auto point = parsePoint(text);
    if (!point) return fail(point.error());
    options.at.push_back(*point);
  }
  if (arguments.automatic || arguments.sequence) {
    if (turns[0] != turns[1] || turns[1] != turns[2])
      return fail("One rotation alone cannot be locked here", "--lock", "Lock attitude as a whole, or refine from observations");
    if (freedom.focal || freedom.principalPoint || freedom.distortion)
      return fail("A calibration is not adjusted from alignments", "--free", "Free rig or clock here, or refine from observations");
    return runPictures(arguments, options, freedom.ties, progress);
  }
  auto project = loadProject(arguments.project);
  if (!project) return fail(project.error());
  auto rows = arguments.observations.empty() ? rowsOf(*project, arguments.frame) : readObservationRows(arguments.observations);
  if (!rows) return fail(rows.error());
  if (rows->empty()) return fail("The project keeps no observation to refine from", arguments.project, "Give --observations FILE");
  if (isResection(*rows, arguments.frame, freedom)) return runResection(*project, arguments, *rows, options);
  return runNetwork(*project, arguments, *rows, freedom, options.at, progress);
}

}  // namespace

void addRefine(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("refine", "Refine the poses of one or several frames from what was observed in them",
                                [arguments](const Progress& progress) { return run(*arguments, progress); });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("--frame", arguments->frame, "Name, or index from 0, of the frame of rows that name none");
  command->add_option("--observations", arguments->observations,
                      "CSV: u,v,e,n,h[,sigma_px][,name][,frame][,kind][,use][,sigma_m][,e2,n2,h2][,depth_m]; "
                      "without it, those that the project keeps");
  command->add_flag("--keep", arguments->keep, "The project keeps the observations of --observations, with the new poses")
      ->needs("--observations");
  command->add_option("--lock", arguments->lock, "Of position,attitude,x,y,z,rx,ry,rz (rotations about the camera's axes)")
      ->check(checkedBy([](const std::string& list) { NetworkFreedom ignored; return applyLocks(list, ignored); }, "LIST"));
  auto* free = command->add_option("--free", arguments->free, "Of focal,principal-point,distortion,rig,clock, beside the poses")
      ->check(checkedBy([](const std::string& list) { NetworkFreedom ignored; return applyFree(list, ignored); }, "LIST"));
  auto* rig = command->add_flag("--rig", arguments->rig, "Cameras with pictures of the same moments sit on one body, as the project or else the poses say; --free rig adjusts where");
  auto* trajectory = command->add_flag("--trajectory", arguments->trajectory, "Hold the poses to their trajectories; --free clock adjusts the clock offset, too");
  command->add_option("--at", arguments->at, "E,N,H where the expected error is wanted")
      ->check(checkedBy(parsePoint, "POINT"));
  auto* automatic = command->add_flag("--auto", arguments->automatic,
                    "Align --frame, or every frame with a pose, with the scans or the designs: from up to 3 degrees and 0.3 m off")
      ->excludes(command->get_option("--observations"))
      ->excludes(free)->excludes(rig)->excludes(trajectory);
  auto* sequence = command->add_flag("--sequence", arguments->sequence,
                    "Align all frames with the scans and adjust them together: tie points, smooth motion, alarm where a fixed camera moved")
      ->excludes("--auto", "--observations", "--frame");
  command->add_option("--keyframes", arguments->keyframes, "With --sequence: align every so many frames; those between follow")
      ->check(CLI::Range(1, 10000))
      ->needs(sequence);
  auto* within = command->add_option("--within", arguments->withinPx, "With --auto and --sequence: the 95 % error, pixels of 1920 across, up to which a pose is believed")
      ->check(numberWithin(0.05, 50.0));
  auto* to = command->add_option("--to", arguments->to, "With --auto and --sequence: what to align with; scan, where one is visible, else design")
      ->transform(CLI::CheckedTransformer(std::map<std::string, AlignTo>{{"scan", AlignTo::Scans}, {"design", AlignTo::Designs}}))
      ->excludes("--observations");
  command->add_flag("--dry-run", arguments->dryRun, "Report only; leave the project as it is");
  command->parse_complete_callback([=] {
    for (const CLI::Option* option : {within, to})
      if (option->count() > 0 && automatic->count() + sequence->count() == 0)
        throw CLI::RequiresError(option->get_name(), "--auto or --sequence");
  });
}

}  // namespace alidade::cli
