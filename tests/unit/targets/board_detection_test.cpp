// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Boards drawn by OpenCV and seen through a known camera: the picture is made pixel by pixel through the inverse of
// our lens, so that where every corner must be is known.

#include <cmath>

#include <gmock/gmock.h>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "adjust/calibration.h"
#include "camera/camera.h"
#include "targets/board_detection.h"

namespace alidade {
namespace {

constexpr int kSquarePx = 60, kMarginPx = 60;

/// The printed board with a white margin; the board's point (0, 0, 0) lies at `origin` in it.
struct Print {
  cv::Mat picture;
  double metresPerPixel = 0;
  glm::dvec2 origin{0};  ///< of the first inner corner; borders between pixels count whole
};

Print printOf(const Board& board) {
  Print print;
  print.metresPerPixel = board.squareM / kSquarePx;
  if (board.kind == BoardKind::Charuco) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100);
    const auto charuco = cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.squareM),
                                                         static_cast<float>(board.markerM), dictionary);
    charuco->draw({board.columns * kSquarePx + 2 * kMarginPx, board.rows * kSquarePx + 2 * kMarginPx}, print.picture, kMarginPx, 1);
  } else {
    print.picture = cv::Mat((board.rows + 1) * kSquarePx + 2 * kMarginPx, (board.columns + 1) * kSquarePx + 2 * kMarginPx, CV_8UC1, cv::Scalar(255));
    for (int r = 0; r <= board.rows; ++r)
      for (int c = 0; c <= board.columns; ++c)
        if ((r + c) % 2 == 0)
          print.picture(cv::Rect(kMarginPx + c * kSquarePx, kMarginPx + r * kSquarePx, kSquarePx, kSquarePx)) = 0;
  }
  print.origin = glm::dvec2(kMarginPx + kSquarePx);
  return print;
}

/// What the camera sees, four samples a pixel each way, their rays interpolated between those of the pixels.
Image<unsigned char> seenThrough(const Camera& camera, const RigidTransform& cameraFromBoard, const Print& print) {
  Image<unsigned char> picture(camera.width(), camera.height(), 128);
  Image<glm::dvec2> rays(camera.width() + 1, camera.height() + 1);
  for (int y = 0; y <= camera.height(); ++y)
    for (int x = 0; x <= camera.width(); ++x)
      rays.at(x, y) = glm::dvec2(camera.unproject({x - 0.5, y - 0.5}).value_or(glm::dvec3(10, 10, 1)));
  const RigidTransform boardFromCamera = cameraFromBoard.inverse();
  const glm::dmat3 rotation = boardFromCamera.rotationMatrix();
  const glm::dvec3 centre = boardFromCamera.translation;
  constexpr int samples = 4;
  for (int y = 0; y < camera.height(); ++y)
    for (int x = 0; x < camera.width(); ++x) {
      int sum = 0;
      for (int s = 0; s < samples * samples; ++s) {
        const double u = (s % samples + 0.5) / samples, v = (s / samples + 0.5) / samples;
        const glm::dvec2 ray = (1 - v) * ((1 - u) * rays.at(x, y) + u * rays.at(x + 1, y)) +
                               v * ((1 - u) * rays.at(x, y + 1) + u * rays.at(x + 1, y + 1));
        const glm::dvec3 direction = rotation * glm::dvec3(ray, 1);
        const double t = -centre.z / direction.z;
        const glm::dvec2 hit = glm::dvec2(centre + t * direction) / print.metresPerPixel + print.origin;
        const bool onPrint = t > 0 && hit.x >= 0 && hit.y >= 0 && hit.x < print.picture.cols && hit.y < print.picture.rows;
        sum += onPrint ? print.picture.at<unsigned char>(static_cast<int>(hit.y), static_cast<int>(hit.x)) : 128;
      }
      picture.at(x, y) = static_cast<unsigned char>(sum / (samples * samples));
    }
  return picture;
}

Camera lens() {
  return Camera(Intrinsics::fromParameters(CameraModel::OpenCv4, 800, 600, {620, 624, 408, 293, -0.18, 0.05, 4e-4, -6e-4}).value());
}

RigidTransform boardAt(const Board& board, const glm::dvec2& pixel, double distance, const glm::dvec3& turn) {
  RigidTransform pose;
  pose.rotation = glm::angleAxis(glm::length(turn), glm::normalize(turn));
  pose.translation = distance * glm::normalize(*lens().unproject(pixel)) - pose.rotation * (0.5 * (board.corners().front() + board.corners().back()));
  return pose;
}

/// Root mean square of found against true places; the numbering of a chessboard may start at its other end.
double rmsOf(const std::vector<BoardCorner>& found, const Board& board, const RigidTransform& pose) {
  const auto corners = board.corners();
  double straight = 0, turned = 0;
  for (const BoardCorner& c : found) {
    const auto away = [&](std::size_t i) {
      const glm::dvec2 d = *lens().project(pose * corners[i]) - c.pixel;
      return glm::dot(d, d) / static_cast<double>(found.size());
    };
    straight += away(c.corner), turned += away(corners.size() - 1 - c.corner);
  }
  return std::sqrt(board.kind == BoardKind::Chessboard ? std::min(straight, turned) : straight);
}

const Board kChessboard{BoardKind::Chessboard, 8, 5, 0.03, 0, {}};
const Board kCharuco{BoardKind::Charuco, 8, 6, 0.03, 0.022, "DICT_5X5_100"};

TEST(BoardDetection, ChessboardCornersAreFoundToATwentiethOfAPixel) {
  const RigidTransform pose = boardAt(kChessboard, {400, 300}, 0.45, {0.4, -0.3, 0.2});
  const auto found = findBoard(seenThrough(lens(), pose, printOf(kChessboard)), kChessboard);
  ASSERT_TRUE(found) << found.error().text();
  ASSERT_EQ(found->size(), 40u);
  EXPECT_LT(rmsOf(*found, kChessboard, pose), 0.05);
}

TEST(BoardDetection, AnEmptyPictureShowsNoBoard) {
  const Image<unsigned char> grey(320, 240, 90);
  for (const Board& board : {kChessboard, kCharuco}) {
    const auto found = findBoard(grey, board);
    ASSERT_TRUE(found) << found.error().text();
    EXPECT_TRUE(found->empty());
  }
  EXPECT_TRUE(findBoard({}, kCharuco)->empty());
}

TEST(BoardDetection, AWrongSizeIsNoticed) {
  const RigidTransform pose = boardAt(kChessboard, {400, 300}, 0.45, {0.4, -0.3, 0.2});
  const auto picture = seenThrough(lens(), pose, printOf(kChessboard));
  Board wrong = kChessboard;
  wrong.columns = 9, wrong.rows = 6;
  EXPECT_TRUE(findBoard(picture, wrong)->empty());
  const auto near = chessboardNear(picture, wrong);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->columns * near->rows, 40);
}

/// The whole way: draw, find, calibrate, with the truth known.
TEST(BoardDetection, CharucoPicturesGiveTheCameraBack) {
  const Print print = printOf(kCharuco);
  std::vector<BoardPicture> pictures;
  std::size_t partly = 0;
  for (int i = 0; i < 9; ++i) {
    const glm::dvec2 at(150 + 250 * (i % 3), 110 + 190 * (i / 3));
    const RigidTransform pose = boardAt(kCharuco, at, 0.32, {0.45 * std::cos(0.8 * i), 0.45 * std::sin(0.8 * i), 0.15 * i - 0.5});
    const auto found = findBoard(seenThrough(lens(), pose, print), kCharuco);
    ASSERT_TRUE(found) << found.error().text();
    partly += !found->empty() && found->size() < kCharuco.corners().size();
    EXPECT_LT(rmsOf(*found, kCharuco, pose), 0.15) << "picture " << i;
    pictures.push_back({"picture " + std::to_string(i), *found});
  }
  EXPECT_GT(partly, 0u) << "boards that leave the picture are part of the test";
  CalibrationOptions options;
  options.model = CameraModel::OpenCv4;
  const auto made = calibrateCamera(kCharuco, 800, 600, pictures, options);
  ASSERT_TRUE(made) << made.error().text();
  ASSERT_TRUE(made->converged) << made->reason;
  EXPECT_LT(made->rmsPx, 0.1);
  const auto truth = lens().intrinsics().parameters(), found = made->intrinsics.parameters();
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[i], truth[i], std::max(0.3, 4 * made->parameterStd[i])) << i;
}

}  // namespace
}  // namespace alidade
