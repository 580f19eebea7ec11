// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/calibration_report.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "report/calibration_plots.h"

namespace alidade {

namespace {

using testing::HasSubstr;

/// Residuals that all point to the right, on the left half of the picture only.
CalibrationSummary lopsided() {
  CalibrationSummary s;
  s.converged = true;
  s.intrinsics = Intrinsics::fromParameters(CameraModel::Pinhole, 800, 600, {700, 700, 400, 300}).value();
  s.parameterStd = {1, 1, 1, 1};
  s.rmsPx = 0.5, s.sigmaPx = 0.35;
  s.pictures.push_back({"a <b> & c.jpg", {}, 0.5, 300, 0, 0.3, 0.6});
  for (int y = 20; y < 600; y += 20)
    for (int x = 20; x < 400; x += 20) s.residuals.push_back({0, 0, {x, y}, {0.5, 0}, false});
  return s;
}

/// Pixels of an area that differ from the ground.
int inked(const ColourImage& image, int x0, int x1) {
  int count = 0;
  const Rgba8 ground = image.at(1, 1);
  for (int y = 30; y < image.height() - 60; ++y)
    for (int x = x0; x < x1; ++x) count += !(image.at(x, y) == ground);
  return count;
}

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct Folder {
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "alidade-report-XXXXXX").string();
    path = mkdtemp(pattern.data());
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string path;
};

}  // namespace

TEST(CalibrationPlots, ResidualsAreDrawnWhereTheyAre) {
  const ColourImage image = calibrationPicture(CalibrationPlot::Residuals, lopsided(), 800, 640, PlotGround::Paper);
  EXPECT_GT(inked(image, 60, 380), 10 * std::max(1, inked(image, 460, 740)));
}

TEST(CalibrationPlots, CoverageShadesCellsThatHoldCorners) {
  const ColourImage image = calibrationPicture(CalibrationPlot::Coverage, lopsided(), 800, 640, PlotGround::Dark);
  EXPECT_GT(inked(image, 60, 380), 3 * inked(image, 460, 740));
}

TEST(CalibrationPlots, ResidualsAlongTheRadiusAreOnTheSideOfTheirSign) {
  CalibrationSummary outwards = lopsided();
  for (CalibrationResidual& r : outwards.residuals) r.residualPx = 0.5 * glm::normalize(r.pixel - glm::dvec2(400, 300));
  const ColourImage image = calibrationPicture(CalibrationPlot::Radial, outwards, 800, 640, PlotGround::Paper);
  int above = 0, below = 0;
  for (int y = 40; y < 520; ++y)
    for (int x = 120; x < 700; ++x) {
      const bool zeroLine = y > 285 && y < 302;
      if (!zeroLine) (y < 293 ? above : below) += !(image.at(x, y) == image.at(1, 1));
    }
  EXPECT_GT(above, 3 * below);
}

TEST(CalibrationReport, IsWrittenAsPageOfEachKind) {
  const Folder folder;
  const CalibrationReport report{"Calibration of <gopro>", "Alidade", "chessboard:8x6:0.025", {"x.jpg: the board was not found"}, lopsided()};
  ASSERT_TRUE(writeCalibrationReport(report, folder.path + "/r.pdf"));
  EXPECT_THAT(contentOf(folder.path + "/r.pdf"), testing::StartsWith("%PDF-"));
  ASSERT_TRUE(writeCalibrationReport(report, folder.path + "/r.png"));
  EXPECT_THAT(contentOf(folder.path + "/r.png"), testing::StartsWith("\x89PNG"));
  ASSERT_TRUE(writeCalibrationReport(report, folder.path + "/r.html"));
  const std::string page = contentOf(folder.path + "/r.html");
  EXPECT_THAT(page, HasSubstr("Calibration of &lt;gopro&gt;"));
  EXPECT_THAT(page, HasSubstr("a &lt;b&gt; &amp; c.jpg"));
  EXPECT_THAT(page, HasSubstr("x.jpg: the board was not found"));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBOR"));
  EXPECT_THAT(writeCalibrationReport(report, folder.path + "/r.doc").error().what, HasSubstr("'.doc'"));
  EXPECT_FALSE(writeCalibrationReport(report, folder.path + "/missing/r.pdf"));
}

}  // namespace alidade
