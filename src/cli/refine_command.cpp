// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"
#include "cli/project_input.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string project, frame, observations, lock;
  std::vector<std::string> at;
  bool dryRun = false;
};

Result<void> applyLocks(const std::string& list, ResectionOptions& options) {
  std::size_t start = 0;
  while (!list.empty() && start <= list.size()) {
    const auto comma = std::min(list.find(',', start), list.size());
    const std::string name = list.substr(start, comma - start);
    if (name == "position") options.lockPosition = {true, true, true};
    else if (name == "attitude") options.lockAttitude = true;
    else if (name == "x" || name == "e") options.lockPosition[0] = true;
    else if (name == "y" || name == "n") options.lockPosition[1] = true;
    else if (name == "z" || name == "h") options.lockPosition[2] = true;
    else return fail("'" + name + "' cannot be locked", "--lock", "Lock position, attitude, x, y or z");
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

Json vec(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

Json jsonOf(const ResectionSummary& summary, bool dryRun) {
  Json json = {{"converged", summary.converged}, {"reason", summary.reason}, {"iterations", summary.iterations},
               {"rms_px", summary.rmsPx}, {"sigma0", summary.sigma0}, {"position_std_m", vec(summary.positionStdM)},
               {"rotation_std_rad", vec(summary.rotationStdRad)}};
  Json expected = Json::array();
  for (const ExpectedError& error : summary.expected) expected.push_back(error.millimetres);
  json["expected_error_mm"] = summary.expected.size() == 1 ? expected[0] : (expected.empty() ? Json(nullptr) : expected);
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

Result<Answer> run(const Arguments& arguments, const Progress& progress) {
  ResectionOptions options;
  if (auto done = applyLocks(arguments.lock, options); !done) return fail(done.error());
  for (const std::string& text : arguments.at) {
    auto point = parsePoint(text);
    if (!point) return fail(point.error());
    options.at.push_back(*point);
  }
  auto open = openProject(arguments.project, arguments.frame, false, progress);
  if (!open) return fail(open.error());
  auto observations = readObservations(arguments.observations);
  if (!observations) return fail(observations.error());
  auto summary = refineFrame(open->project, open->frame, *observations, options, arguments.dryRun);
  if (!summary) return fail(summary.error());
  if (summary->converged && !arguments.dryRun)
    if (auto saved = saveProject(open->project, arguments.project); !saved) return fail(saved.error());

  Answer answer;
  answer.json = jsonOf(*summary, arguments.dryRun);
  answer.text = summary->report();
  if (!answer.text.ends_with('\n')) answer.text += '\n';
  answer.failed = !summary->converged;
  return answer;
}

}  // namespace

void addRefine(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("refine", "Refine a frame's pose from observations of known points",
                                [arguments](const Progress& progress) { return run(*arguments, progress); });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("--frame", arguments->frame, "Name, or index from 0")->required();
  command->add_option("--observations", arguments->observations, "CSV: u,v,e,n,h[,sigma_px[,name]]")->required();
  command->add_option("--lock", arguments->lock, "Of position,attitude,x,y,z")
      ->check(checkedBy([](const std::string& list) { ResectionOptions ignored; return applyLocks(list, ignored); }, "LIST"));
  command->add_option("--at", arguments->at, "E,N,H where the expected error is wanted")
      ->check(checkedBy(parsePoint, "POINT"));
  command->add_flag("--dry-run", arguments->dryRun, "Report only; leave the project as it is");
}

}  // namespace alidade::cli
