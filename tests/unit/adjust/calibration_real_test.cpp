// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Real chessboards, with OpenCV's own calibration of the same corners beside ours.

#include <cmath>
#include <filesystem>
#include <set>

#include <gmock/gmock.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "adjust/calibration.h"
#include "targets/board_detection.h"

namespace alidade {
namespace {

using testing::HasSubstr;

const Board kBoard{BoardKind::Chessboard, 8, 6, 0.025, 0, {}};
constexpr int kWidth = 1280, kHeight = 960;

/// The corners of all pictures in which the board is found; searched for once.
const std::vector<BoardPicture>& realPictures() {
  static const std::vector<BoardPicture> found = [] {
    std::vector<BoardPicture> pictures;
    const std::filesystem::path folder = ALIDADE_SHARED_DATA_DIR "/calib_chessboard_8x6/calibration_wide";
    std::set<std::filesystem::path> paths;
    if (std::filesystem::exists(folder))
      for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename() != "test_image.jpg") paths.insert(entry.path());
    for (const auto& path : paths) {
      const cv::Mat grey = cv::imread(path.string(), cv::IMREAD_GRAYSCALE);
      Image<unsigned char> image(grey.cols, grey.rows);
      std::copy(grey.datastart, grey.dataend, image.data());
      const auto corners = findBoard(image, kBoard);
      if (corners && !corners->empty()) pictures.push_back({path.filename().string(), *corners});
    }
    return pictures;
  }();
  return found;
}

/// cv::calibrateCamera on the same corners.
struct Peer {
  double rms = 0;
  cv::Mat matrix, distortion, intrinsicStd;
};
Peer openCv(const std::vector<BoardPicture>& pictures, int flags) {
  const auto corners = kBoard.corners();
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> seen;
  for (const BoardPicture& picture : pictures) {
    auto& b = board.emplace_back();
    auto& s = seen.emplace_back();
    for (const BoardCorner& c : picture.corners) {
      b.emplace_back(corners[c.corner].x, corners[c.corner].y, 0);
      s.emplace_back(c.pixel.x, c.pixel.y);
    }
  }
  Peer peer;
  std::vector<cv::Mat> r, t;
  cv::Mat extrinsicStd, perView;
  const cv::TermCriteria until(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 1000, 1e-14);
  peer.rms = cv::calibrateCamera(board, seen, {kWidth, kHeight}, peer.matrix, peer.distortion, r, t, peer.intrinsicStd,
                                 extrinsicStd, perView, flags, until);
  return peer;
}

class RealChessboards : public testing::Test {
 protected:
  void SetUp() override {
    if (realPictures().empty()) GTEST_SKIP() << "SKIPPED: " << ALIDADE_SHARED_DATA_DIR << "/calib_chessboard_8x6 is not there";
  }
  static CalibrationSummary plain(CameraModel model) {
    CalibrationOptions options;
    options.model = model, options.robust = false;
    const auto made = calibrateCamera(kBoard, kWidth, kHeight, realPictures(), options);
    EXPECT_TRUE(made) << made.error().text();
    return *made;
  }
};

TEST_F(RealChessboards, FiveCoefficientsComeOutAsOpenCvHasThem) {
  const CalibrationSummary ours = plain(CameraModel::OpenCv5);
  ASSERT_TRUE(ours.converged) << ours.reason;
  const Peer peer = openCv(realPictures(), 0);
  EXPECT_NEAR(ours.rmsPx, peer.rms, 0.001 * peer.rms);
  // The data set's published answer.
  EXPECT_NEAR(ours.rmsPx, 0.524, 0.01 * 0.524);
  EXPECT_NEAR(ours.intrinsics.fx, 560.16, 0.3);
  EXPECT_NEAR(ours.intrinsics.cy, 498.94, 0.3);
  EXPECT_NEAR(ours.intrinsics.distortion.k[0], -0.2327, 5e-4);
  const auto values = ours.intrinsics.parameters();
  const double theirs[] = {peer.matrix.at<double>(0, 0), peer.matrix.at<double>(1, 1), peer.matrix.at<double>(0, 2),
                           peer.matrix.at<double>(1, 2)};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(values[i], theirs[i], 0.02) << i;
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(values[4 + i], peer.distortion.at<double>(i), 2e-4) << i;
  // OpenCV divides the sum of squares by points less unknowns, where the two coordinates of each are measured.
  const double points = static_cast<double>(ours.residuals.size()), unknowns = 9 + 6.0 * static_cast<double>(ours.pictures.size());
  const double byPoints = std::sqrt((points - unknowns) / (2 * points - unknowns));
  for (int i = 0; i < 9; ++i) {
    const double theirStd = byPoints * peer.intrinsicStd.at<double>(i);
    EXPECT_NEAR(ours.parameterStd[i], theirStd, 0.01 * theirStd) << i;
  }
  // One picture alone shows the board in that corner.
  EXPECT_THAT(ours.warnings, testing::Contains(HasSubstr("GOPR0064.jpg fits with")));
}

TEST_F(RealChessboards, TheRationalModelFitsAsWellAsOpenCvs) {
  const CalibrationSummary ours = plain(CameraModel::OpenCv8);
  ASSERT_TRUE(ours.converged) << ours.reason;
  EXPECT_LE(ours.rmsPx, 1.001 * openCv(realPictures(), cv::CALIB_RATIONAL_MODEL).rms);
}

TEST_F(RealChessboards, ALensWithoutDistortionIsRefusedForThem) {
  const CalibrationSummary ours = plain(CameraModel::Pinhole);
  EXPECT_FALSE(ours.converged);
  EXPECT_THAT(ours.reason, HasSubstr("is undetermined"));
}

}  // namespace
}  // namespace alidade
