// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/calibrate.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "base/parallel.h"
#include "io/picture_file.h"
#include "plugin_api/picture_header.h"
#include "plugin_api/text_file.h"
#include "targets/board_detection.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

bool namesPicture(const fs::path& path) {
  const std::string extension = lowerCase(path.extension().string());
  return extension.size() > 1 && isPictureExtension(extension.substr(1)) && !path.filename().string().starts_with('.');
}

/// Files as given, and the pictures of folders in the order of their names.
Result<std::vector<std::string>> picturesOf(const std::vector<std::string>& given) {
  std::vector<std::string> paths;
  for (const std::string& path : given) {
    std::error_code error;
    if (!fs::is_directory(path, error)) {
      paths.push_back(path);
      continue;
    }
    std::vector<std::string> inside;
    for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error))
      if (namesPicture(it->path())) inside.push_back(it->path().string());
    if (error) return fail("The folder cannot be read: " + error.message(), path, "Check its permissions");
    if (inside.empty()) return fail("The folder holds no picture", path, "Give a folder with JPEG, PNG or TIFF files");
    std::sort(inside.begin(), inside.end());
    paths.insert(paths.end(), inside.begin(), inside.end());
  }
  if (paths.empty()) return fail("No picture was given", {}, "Give pictures of the board, or a folder of them");
  return paths;
}

struct Searched {
  int width = 0, height = 0;
  std::vector<BoardCorner> corners;
  std::string problem;
};

Searched search(const std::string& path, const Board& board) {
  Searched result;
  const auto picture = readPicture(path);
  if (!picture) {
    result.problem = picture.error().what;
    return result;
  }
  result.width = picture->width(), result.height = picture->height();
  auto corners = findBoard(greyOf(*picture), board);
  if (!corners) result.problem = corners.error().what;
  else if (corners->empty()) result.problem = "the board was not found";
  else result.corners = std::move(*corners);
  return result;
}

/// The size that most of the pictures with a board have.
std::pair<int, int> commonSize(const std::vector<Searched>& all) {
  std::map<std::pair<int, int>, int> counts;
  for (const Searched& s : all)
    if (!s.corners.empty()) ++counts[{s.width, s.height}];
  const auto most = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? std::pair(0, 0) : most->first;
}

/// What to do where no picture shows the board: perhaps it has another size.
std::string adviceFor(const Board& board, const std::vector<std::string>& paths, const Progress& progress) {
  constexpr std::size_t most = 3;
  for (std::size_t i = 0; i < std::min(most, paths.size()) && !progress.cancelled(); ++i)
    if (const auto picture = readPicture(paths[i]))
      if (const auto other = chessboardNear(greyOf(*picture), board))
        return fmt::format("{} shows a board of {}x{} inner corners: give {}", fs::path(paths[i]).filename().string(), other->columns,
                           other->rows, other->text());
  return board.kind == BoardKind::Chessboard ? "Give the number of inner corners (one less than squares each way); the whole board with "
                                               "a white margin must be seen"
                                             : "Give the number of squares and the dictionary that the board was printed with";
}

}  // namespace

Result<CalibrationOutcome> calibrate(const CalibrationJob& job, const Progress& progress) {
  if (const auto valid = job.options.validate(); !valid) return fail(valid.error());
  const auto paths = picturesOf(job.pictures);
  if (!paths) return fail(paths.error());
  std::vector<Searched> searched(paths->size());
  std::atomic<std::size_t> done{0};
  const Progress finding = progress.part(0, 0.8);
  parallelFor(paths->size(), 1, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) {
      if (progress.cancelled()) return;
      searched[i] = search((*paths)[i], job.board);
      finding.report(static_cast<double>(++done) / static_cast<double>(paths->size()),
                     "Looking for the board in " + fs::path((*paths)[i]).filename().string());
    }
  });
  if (progress.cancelled()) return fail(cancelledError());

  CalibrationOutcome outcome;
  outcome.board = job.board;
  std::tie(outcome.width, outcome.height) = commonSize(searched);
  for (std::size_t i = 0; i < searched.size(); ++i) {
    const Searched& s = searched[i];
    const std::string name = fs::path((*paths)[i]).filename().string();
    if (!s.problem.empty()) outcome.leftOut.push_back(fmt::format("{}: {}", name, s.problem));
    else if (s.width != outcome.width || s.height != outcome.height)
      outcome.leftOut.push_back(fmt::format("{}: it has {} × {} px, the others {} × {}", name, s.width, s.height, outcome.width, outcome.height));
    else outcome.found.push_back({name, s.corners});
  }
  if (outcome.found.empty()) {
    const bool onlyUnreadable = std::all_of(searched.begin(), searched.end(), [](const Searched& s) { return s.width == 0; });
    if (onlyUnreadable)
      return fail(fmt::format("None of the {} pictures can be read; the first: {}", paths->size(), searched[0].problem), (*paths)[0],
                  "Give JPEG, PNG or TIFF pictures");
    return fail(fmt::format("None of the {} pictures shows the board {}", paths->size(), job.board.text()), {},
                adviceFor(job.board, *paths, progress));
  }
  auto summary = calibrateCamera(job.board, outcome.width, outcome.height, outcome.found, job.options, progress.part(0.8, 1));
  if (!summary) return fail(summary.error());
  outcome.summary = std::move(*summary);
  return outcome;
}

Result<void> keepCalibration(Project& project, const Intrinsics& intrinsics, const std::string& name) {
  bool found = false;
  std::int64_t largest = 0;
  for (const CameraRecord& record : project.cameras) {
    largest = std::max(largest, record.id.value);
    if (record.name != name) continue;
    found = true;
    if (record.camera.width() != intrinsics.width || record.camera.height() != intrinsics.height)
      return fail(fmt::format("The camera '{}' takes pictures of {} × {} px, the calibration is for {} × {}", name, record.camera.width(),
                              record.camera.height(), intrinsics.width, intrinsics.height),
                  project.path, "Calibrate with pictures of the size that the project has");
  }
  for (CameraRecord& record : project.cameras)
    if (record.name == name) record.camera = Camera(intrinsics);
  if (found) return {};
  CameraRecord record;
  record.id.value = largest + 1;
  record.name = name;
  record.camera = Camera(intrinsics);
  project.cameras.push_back(std::move(record));
  return {};
}

}  // namespace alidade
