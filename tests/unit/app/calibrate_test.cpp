// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/calibrate.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "io/picture_file.h"

namespace alidade {
namespace {

using testing::Contains;
using testing::HasSubstr;

class Calibrate : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "alidade-calibrate-XXXXXX").string();
    m_folder = mkdtemp(pattern.data());
    job.board = {BoardKind::Chessboard, 8, 6, 0.025, 0, {}};
  }
  void TearDown() override { std::filesystem::remove_all(m_folder); }
  std::string blank(const std::string& name, int width, int height) {
    const std::string path = m_folder + "/" + name;
    EXPECT_TRUE(writePng(ColourImage(width, height, {90, 90, 90, 255}), path));
    return path;
  }
  std::string m_folder;
  CalibrationJob job;
};

TEST_F(Calibrate, PicturesWithoutABoardAreListedWithTheirReason) {
  const std::string real = ALIDADE_SHARED_DATA_DIR "/calib_chessboard_8x6/calibration_wide/";
  if (!std::filesystem::exists(real)) GTEST_SKIP() << "SKIPPED: " << real << " is not there";
  for (const char* name : {"GOPR0038.jpg", "GOPR0040.jpg", "GOPR0064.jpg", "GOPR0068.jpg"}) job.pictures.push_back(real + name);
  job.pictures.push_back(blank("blank.png", 320, 240));
  job.pictures.push_back(m_folder + "/missing.jpg");
  std::ofstream(m_folder + "/text.jpg") << "no picture at all";
  job.pictures.push_back(m_folder + "/text.jpg");
  job.options.model = CameraModel::Radial;
  const auto outcome = calibrate(job, {});
  ASSERT_TRUE(outcome) << outcome.error().text();
  EXPECT_EQ(outcome->found.size(), 4u);
  EXPECT_EQ(outcome->width, 1280);
  ASSERT_EQ(outcome->leftOut.size(), 3u);
  EXPECT_EQ(outcome->leftOut[0], "blank.png: the board was not found");
  EXPECT_THAT(outcome->leftOut[1], HasSubstr("missing.jpg: "));
  EXPECT_THAT(outcome->leftOut[2], HasSubstr("text.jpg: "));
}

TEST_F(Calibrate, AWrongBoardSizeIsAnErrorThatNamesTheRightOne) {
  const std::string real = ALIDADE_SHARED_DATA_DIR "/calib_chessboard_8x6/calibration_wide/GOPR0043.jpg";
  if (!std::filesystem::exists(real)) GTEST_SKIP() << "SKIPPED: " << real << " is not there";
  job.pictures = {real};
  job.board.columns = 9, job.board.rows = 7;
  const auto outcome = calibrate(job, {});
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().what, HasSubstr("None of the 1 pictures shows the board chessboard:9x7:0.025"));
  EXPECT_THAT(outcome.error().advice, HasSubstr("give chessboard:8x6:0.025"));
}

TEST_F(Calibrate, NothingToReadIsAnError) {
  EXPECT_THAT(calibrate(job, {}).error().what, HasSubstr("No picture was given"));
  job.pictures = {m_folder};
  EXPECT_THAT(calibrate(job, {}).error().what, HasSubstr("holds no picture"));
  job.pictures = {m_folder + "/missing.jpg"};
  EXPECT_THAT(calibrate(job, {}).error().what, HasSubstr("None of the 1 pictures can be read"));
}

TEST_F(Calibrate, CancelStopsIt) {
  job.pictures = {blank("a.png", 64, 48)};
  const Progress progress;
  progress.cancel();
  const auto outcome = calibrate(job, progress);
  ASSERT_FALSE(outcome);
  EXPECT_TRUE(isCancelled(outcome.error()));
}

TEST_F(Calibrate, KeepingReplacesTheCameraOfThatNameOrAddsOne) {
  const Intrinsics lens = Intrinsics::fromParameters(CameraModel::Pinhole, 800, 600, {700, 700, 400, 300}).value();
  Project project;
  ASSERT_TRUE(keepCalibration(project, lens, "front"));
  ASSERT_EQ(project.cameras.size(), 1u);
  EXPECT_TRUE(project.cameras[0].id);
  Intrinsics better = lens;
  better.fx = 702;
  ASSERT_TRUE(keepCalibration(project, better, "front"));
  ASSERT_EQ(project.cameras.size(), 1u);
  EXPECT_EQ(project.cameras[0].camera.intrinsics().fx, 702);
  better.width = 1600;
  EXPECT_THAT(keepCalibration(project, better, "front").error().what, HasSubstr("takes pictures of 800 × 600"));
  EXPECT_EQ(project.cameras[0].camera.width(), 800);
}

}  // namespace
}  // namespace alidade
