// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <charconv>
#include <cmath>
#include <fstream>
#include <map>

#include "app/jobs.h"

namespace alidade {

namespace {

std::string trimmed(std::string text) {
  const auto first = text.find_first_not_of(" \t\r\"");
  const auto last = text.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> found;
  std::size_t start = 0;
  for (;;) {
    const auto comma = line.find(',', start);
    found.push_back(trimmed(line.substr(start, comma == std::string::npos ? comma : comma - start)));
    if (comma == std::string::npos) return found;
    start = comma + 1;
  }
}

std::optional<double> number(const std::string& cell) {
  double value = 0;
  const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

Result<std::vector<ResectionObservation>> readObservations(const std::string& path) {
  constexpr const char* kAdvice = "The file needs the header u,v,e,n,h[,sigma_px[,name]]";
  std::ifstream file(path);
  if (!file) return fail("The observations cannot be opened", path, "Check that the file exists and may be read");
  std::string line;
  std::map<std::string, std::size_t> column;
  std::vector<ResectionObservation> observations;
  for (int lineNumber = 1; std::getline(file, line); ++lineNumber) {
    if (line.size() > 65536) return fail("A line is longer than 65536 characters", path, kAdvice);
    if (lineNumber == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (trimmed(line).empty() || line.front() == '#') continue;
    const auto cell = cells(line);
    if (column.empty()) {
      for (std::size_t i = 0; i < cell.size(); ++i) {
        std::string name = cell[i];
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        column[name] = i;
      }
      for (const char* needed : {"u", "v", "e", "n", "h"})
        if (!column.contains(needed)) return fail(std::string("The column '") + needed + "' is missing", path, kAdvice);
      continue;
    }
    const std::string where = path + ", line " + std::to_string(lineNumber);
    const auto value = [&](const char* name) { return column.at(name) < cell.size() ? number(cell[column.at(name)]) : std::nullopt; };
    ResectionObservation seen;
    const auto u = value("u"), v = value("v"), e = value("e"), n = value("n"), h = value("h");
    if (!u || !v || !e || !n || !h) return fail("u, v, e, n and h must be finite numbers", where, kAdvice);
    seen.pixel = {*u, *v};
    seen.world = {*e, *n, *h};
    if (column.contains("sigma_px") && column.at("sigma_px") < cell.size() && !cell[column.at("sigma_px")].empty()) {
      const auto sigma = value("sigma_px");
      if (!sigma || *sigma <= 0) return fail("sigma_px must be above 0", where, kAdvice);
      seen.sigmaPx = *sigma;
    }
    if (column.contains("name") && column.at("name") < cell.size()) seen.name = cell[column.at("name")];
    if (seen.name.empty()) seen.name = "line " + std::to_string(lineNumber);
    observations.push_back(std::move(seen));
  }
  if (observations.empty()) return fail("The file holds no observation", path, kAdvice);
  return observations;
}

Result<ResectionSummary> refineFrame(Project& project, FrameId frameId,
                                     const std::vector<ResectionObservation>& observations,
                                     const ResectionOptions& options, bool dryRun) {
  Frame* frame = project.findFrame(frameId);
  if (!frame) return fail("The project holds no such frame", project.path);
  const CameraRecord* camera = project.findCamera(frame->camera);
  if (!camera) return fail("Frame '" + frame->name + "' has no camera", project.path, "Add a calibration first");
  if (!frame->cameraFromWorld)
    return fail("Frame '" + frame->name + "' has no pose to start from", project.path, "Add poses that cover this frame");
  auto summary = resect(camera->camera, *frame->cameraFromWorld, observations, options);
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
