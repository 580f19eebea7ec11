// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "app/calibrate.h"
#include "app/version.h"
#include "cli/command.h"
#include "io/calibration_writer.h"
#include "io/project_store.h"
#include "report/calibration_report.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::vector<std::string> pictures;
  std::string board, model = "OPENCV5", output, report, project, camera = "calibrated";
  bool plain = false;
  double boardSigma = 0;
  int parts = 5;
};

Result<CameraModel> modelOf(const std::string& text) {
  if (const auto model = parseCameraModel(text)) return *model;
  std::string names;
  for (int i = 0; i <= static_cast<int>(CameraModel::BrownSkewed); ++i)
    names += fmt::format("{}{}", i ? ", " : "", cameraModelName(static_cast<CameraModel>(i)));
  return fail(fmt::format("There is no camera model '{}'", text), {}, "Give one of " + names);
}

Json numberOrNull(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json jsonOf(const CalibrationOutcome& outcome) {
  const CalibrationSummary& s = outcome.summary;
  Json json{{"converged", s.converged}, {"reason", s.reason}, {"board", outcome.board.text()}, {"width", outcome.width},
            {"height", outcome.height}, {"left_out", outcome.leftOut}, {"warnings", s.warnings}};
  if (!s.converged) return json;
  json["model"] = cameraModelName(s.intrinsics.model);
  const auto names = parameterNames(s.intrinsics.model);
  const auto values = s.intrinsics.parameters();
  Json parameters = Json::object();
  for (std::size_t i = 0; i < names.size(); ++i) parameters[names[i]] = {{"value", values[i]}, {"std", s.parameterStd[i]}};
  json["parameters"] = std::move(parameters);
  json["correlation"] = s.correlation;
  json["rms_px"] = s.rmsPx;
  json["sigma_px"] = s.sigmaPx;
  json["held_out_rms_px"] = numberOrNull(s.heldOutRmsPx);
  json["coverage"] = s.coverage;
  json["corners"] = s.residuals.size();
  json["outliers"] = s.outliers;
  json["redundancy"] = s.redundancy;
  json["iterations"] = s.iterations;
  json["correlations"] = s.correlations;
  if (s.board)
    json["board_shape"] = {{"off_plane_m", s.board->offPlaneM}, {"in_plane_m", s.board->inPlaneM}, {"worst_m", s.board->worstM},
                           {"worst_corner", s.board->worstCorner}};
  Json pictures = Json::array();
  for (const CalibratedPicture& p : s.pictures) {
    const glm::dquat& q = p.cameraFromBoard.rotation;
    const glm::dvec3& t = p.cameraFromBoard.translation;
    pictures.push_back({{"name", p.name}, {"corners", p.corners}, {"outliers", p.outliers}, {"rms_px", p.rmsPx},
                        {"held_out_rms_px", numberOrNull(p.heldOutRmsPx)}, {"tilt_rad", p.tiltRad},
                        {"camera_from_board_wxyz", {q.w, q.x, q.y, q.z}}, {"camera_from_board_m", {t.x, t.y, t.z}}});
  }
  json["pictures"] = std::move(pictures);
  return json;
}

Result<void> keep(const Arguments& arguments, const CalibrationOutcome& outcome) {
  const CalibrationSummary& s = outcome.summary;
  if (!arguments.output.empty())
    if (auto done = writeCalibration(s.intrinsics, {s.rmsPx, static_cast<int>(s.pictures.size())}, arguments.output); !done) return done;
  if (arguments.project.empty()) return {};
  auto project = loadProject(arguments.project);
  if (!project) return fail(project.error());
  if (auto done = keepCalibration(*project, s.intrinsics, arguments.camera); !done) return done;
  return saveProject(*project, arguments.project);
}

Result<Answer> run(const Arguments& arguments, const Progress& progress) {
  CalibrationJob job;
  job.pictures = arguments.pictures;
  auto board = Board::parse(arguments.board);
  if (!board) return fail(board.error());
  job.board = std::move(*board);
  const auto model = modelOf(arguments.model);
  if (!model) return fail(model.error());
  job.options.model = *model, job.options.robust = !arguments.plain;
  job.options.boardSigmaM = arguments.boardSigma, job.options.parts = arguments.parts;
  const auto outcome = calibrate(job, progress);
  if (!outcome) return fail(outcome.error());
  Answer answer;
  answer.json = jsonOf(*outcome);
  answer.text = outcome->summary.report();
  for (const std::string& line : outcome->leftOut) answer.text += "  left out: " + line + "\n";
  answer.failed = !outcome->summary.converged;
  if (!answer.failed)
    if (auto kept = keep(arguments, *outcome); !kept) return fail(kept.error());
  if (!arguments.report.empty()) {
    const CalibrationReport report{fmt::format("Calibration of {}", arguments.camera), std::string(softwareName()), outcome->board.text(),
                                   outcome->leftOut, outcome->summary};
    if (auto written = writeCalibrationReport(report, arguments.report); !written) return fail(written.error());
  }
  return answer;
}

}  // namespace

void addCalibrate(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("calibrate", "Calibrate a camera from pictures of a chessboard or ChArUco board",
                                [arguments](const Progress& progress) { return run(*arguments, progress); });
  command->add_option("pictures", arguments->pictures, "Pictures of the board, or folders of them")->required();
  command->add_option("--board", arguments->board,
                      "chessboard:COLUMNSxROWS:SQUARE (inner corners, metres) or charuco:COLUMNSxROWS:SQUARE:MARKER:DICTIONARY (squares)")
      ->required()
      ->check(checkedBy(Board::parse, "BOARD"));
  command->add_option("--model", arguments->model, "Camera model: PINHOLE, OPENCV, OPENCV5, FULL_OPENCV, OPENCV_FISHEYE …")
      ->capture_default_str()
      ->check(checkedBy(modelOf, "MODEL"));
  command->add_option("-o,--output", arguments->output, "Calibration file: .yml, .xml or .json as OpenCV's, .txt as COLMAP's");
  command->add_option("--report", arguments->report, "Figures, residual plot and coverage as .pdf, .html or .png");
  command->add_flag("--plain", arguments->plain, "Plain least squares over all corners, wrong ones too");
  command->add_option("--board-sigma", arguments->boardSigma, "Metres by which the print may be off: the board's corners are adjusted, too")
      ->check(finiteNumber());
  command->add_option("--held-out-parts", arguments->parts, "Parts in which the pictures are left out for the check; 0: no check")
      ->capture_default_str();
  command->add_option("--project", arguments->project, "Project that the calibration is given to");
  command->add_option("--camera", arguments->camera, "Name of its camera there, and in the report")->capture_default_str();
}

}  // namespace alidade::cli
