// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/calibration_checks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "geometry/angle.h"

namespace alidade {

namespace {

glm::dvec3 normalOf(const RigidTransform& cameraFromBoard) {
  return cameraFromBoard.rotation * glm::dvec3(0, 0, 1);
}

/// How far from the middle the farthest corner lies, as a share of the way to the picture's own corner.
double reachOf(int width, int height, const std::vector<BoardPicture>& pictures) {
  const glm::dvec2 middle(0.5 * (width - 1), 0.5 * (height - 1));
  double farthest = 0;
  for (const BoardPicture& picture : pictures)
    for (const BoardCorner& c : picture.corners) farthest = std::max(farthest, glm::length(c.pixel - middle));
  return farthest / glm::length(middle);
}

double coverageOf(const Intrinsics& in, const std::vector<CalibrationResidual>& residuals) {
  constexpr int columns = 8, rows = 6;
  std::set<std::pair<int, int>> cells;
  for (const CalibrationResidual& r : residuals)
    cells.emplace(std::clamp(static_cast<int>((r.pixel.x + 0.5) / in.width * columns), 0, columns - 1),
                  std::clamp(static_cast<int>((r.pixel.y + 0.5) / in.height * rows), 0, rows - 1));
  return static_cast<double>(cells.size()) / (columns * rows);
}

}  // namespace

Result<void> checkBoardPictures(const Board& board, int width, int height, const std::vector<BoardPicture>& pictures) {
  if (width < 16 || height < 16) return fail(fmt::format("Pictures of {}×{} pixels cannot be calibrated", width, height));
  const int count = board.cornerColumns() * board.cornerRows();
  for (const BoardPicture& picture : pictures) {
    std::set<int> seen;
    for (const BoardCorner& c : picture.corners) {
      if (c.corner < 0 || c.corner >= count)
        return fail(fmt::format("The board has {} corners, number {} was observed", count, c.corner), picture.name);
      if (!std::isfinite(c.pixel.x) || !std::isfinite(c.pixel.y))
        return fail(fmt::format("The place of corner {} is not finite", c.corner), picture.name);
      if (!seen.insert(c.corner).second) return fail(fmt::format("Corner {} was observed twice", c.corner), picture.name);
    }
  }
  return {};
}

bool carriesPose(const Board& board, const BoardPicture& picture) {
  std::set<int> rows, columns;
  for (const BoardCorner& c : picture.corners)
    rows.insert(c.corner / board.cornerColumns()), columns.insert(c.corner % board.cornerColumns());
  return picture.corners.size() >= 6 && rows.size() >= 2 && columns.size() >= 2;
}

std::optional<std::string> refusalOfCoverage(int width, int height, const std::vector<BoardPicture>& pictures) {
  constexpr double least = 0.5;
  const double reach = reachOf(width, height, pictures);
  if (reach >= least) return std::nullopt;
  return fmt::format("The board never leaves the middle: no corner lies farther out than {:.0f} % of the way to the picture's "
                     "corner; take pictures with the board at the edges and in the corners", 100 * reach);
}

double boardTilt(const RigidTransform& cameraFromBoard) {
  return std::acos(std::min(1.0, std::abs(normalOf(cameraFromBoard).z)));
}

std::optional<std::string> refusalOfAttitudes(const std::vector<RigidTransform>& poses, double withinRad) {
  const double alike = degreesFromRadians(withinRad);
  double tilt = 0, between = 0, turned = 0, moved = 0;
  for (const RigidTransform& a : poses) {
    tilt = std::max(tilt, degreesFromRadians(boardTilt(a)));
    for (const RigidTransform& b : poses) {
      between = std::max(between, degreesFromRadians(std::acos(std::clamp(glm::dot(normalOf(a), normalOf(b)), -1.0, 1.0))));
      turned = std::max(turned, degreesFromRadians(rotationAngleBetween(a, b)));
      moved = std::max(moved, glm::length(a.translation - b.translation) / glm::length(a.translation));
    }
  }
  if (turned < alike && moved < 0.05)
    return "The board has the same pose in all pictures; move and tilt the board or the camera between them";
  if (tilt < alike)
    return fmt::format("The board is parallel to the image in all pictures (largest tilt {:.1f}°): the focal length and the "
                       "distance cannot be told apart; tilt the board by 20° to 45°, each time to another side", tilt);
  if (between < alike)
    return fmt::format("The board has the same attitude in all pictures (its normals differ by {:.1f}° at most), which fixes no "
                       "focal length and principal point; tilt the board each time to another side", between);
  return std::nullopt;
}

std::optional<std::string> refusalOfAccuracy(const CalibrationSummary& summary) {
  constexpr double worstFocal = 0.03, worstPoint = 0.05;
  const Intrinsics& in = summary.intrinsics;
  const auto names = parameterNames(in.model);
  const auto values = in.parameters();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool focal = names[i].starts_with('f'), point = names[i].starts_with('c');
    const double limit = focal ? worstFocal * values[i] : worstPoint * in.width;
    if ((focal || point) && !(summary.parameterStd[i] <= limit))
      return fmt::format("{} is undetermined: {:.1f} px with a standard deviation of {:.1f} px, the residuals being {:.2f} px; take more pictures, with the "
                         "board tilted to all sides and all over the picture, or another model",
                         names[i], values[i], summary.parameterStd[i], summary.rmsPx);
  }
  return std::nullopt;
}

void judgeCalibration(const CameraAccuracy& accuracy, CalibrationSummary& summary) {
  constexpr double high = 0.95, weakTilt = 15, wellCovered = 0.6;
  const Intrinsics& in = summary.intrinsics;
  const auto names = parameterNames(in.model);
  for (std::size_t a = 0; a < names.size(); ++a)
    for (std::size_t b = a + 1; b < names.size(); ++b) {
      const double r = summary.correlation[a * names.size() + b];
      const bool bothFocal = names[a] == "fx" && names[b] == "fy";  // alike for every camera with square pixels
      if (std::abs(r) >= high && !bothFocal)
        summary.correlations.push_back(fmt::format("{} and {} can hardly be told apart (correlation {:.3f})", names[a], names[b], r));
    }
  const auto& distances = accuracy.focalWithDistance;
  const auto alike = std::count_if(distances.begin(), distances.end(), [](double r) { return std::abs(r) >= high; });
  if (alike > 0)
    summary.correlations.push_back(fmt::format("{} and the camera's distance can hardly be told apart in {} of {} pictures; "
                                               "tilt the board more", names[0], alike, distances.size()));

  double tilt = 0;
  for (const CalibratedPicture& picture : summary.pictures) tilt = std::max(tilt, degreesFromRadians(picture.tiltRad));
  if (tilt < weakTilt)
    summary.warnings.push_back(fmt::format("The board is tilted by {:.0f}° at most; 20° to 45° fix the focal length better", tilt));
  summary.coverage = coverageOf(in, summary.residuals);
  if (summary.coverage < wellCovered)
    summary.warnings.push_back(fmt::format("Corners lie in {:.0f} % of the picture's cells only; the lens is a guess in the others",
                                           100 * summary.coverage));
  const Camera camera(in);
  for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(in.width - 1, 0), glm::dvec2(0, in.height - 1),
                                  glm::dvec2(in.width - 1, in.height - 1)})
    if (!camera.unproject(corner)) {
      summary.warnings.push_back("The lens folds back before the picture's corner: nothing is drawn there; take pictures with the "
                                 "board in the corners, or a model with fewer parameters");
      break;
    }
}

}  // namespace alidade
