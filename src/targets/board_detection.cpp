// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "targets/board_detection.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>

#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace alidade {

namespace {

using Dictionary = cv::aruco::PREDEFINED_DICTIONARY_NAME;

const std::map<std::string, Dictionary>& dictionaries() {
  using namespace cv::aruco;
  static const std::map<std::string, Dictionary> all{
      {"DICT_4X4_50", DICT_4X4_50},         {"DICT_4X4_100", DICT_4X4_100},
      {"DICT_4X4_250", DICT_4X4_250},       {"DICT_4X4_1000", DICT_4X4_1000},
      {"DICT_5X5_50", DICT_5X5_50},         {"DICT_5X5_100", DICT_5X5_100},
      {"DICT_5X5_250", DICT_5X5_250},       {"DICT_5X5_1000", DICT_5X5_1000},
      {"DICT_6X6_50", DICT_6X6_50},         {"DICT_6X6_100", DICT_6X6_100},
      {"DICT_6X6_250", DICT_6X6_250},       {"DICT_6X6_1000", DICT_6X6_1000},
      {"DICT_7X7_50", DICT_7X7_50},         {"DICT_7X7_100", DICT_7X7_100},
      {"DICT_7X7_250", DICT_7X7_250},       {"DICT_7X7_1000", DICT_7X7_1000},
      {"DICT_ARUCO_ORIGINAL", DICT_ARUCO_ORIGINAL}};
  return all;
}

cv::Mat viewOf(const Image<unsigned char>& grey) {
  return cv::Mat(grey.height(), grey.width(), CV_8UC1, const_cast<unsigned char*>(grey.data()));
}

/// Moves corners to the saddle of grey; `clear`: share of the way to the next corner where nothing else is drawn.
/// OpenCV's own advice for half the window is 11 at most.
void refine(const cv::Mat& grey, double clear, std::vector<cv::Point2f>& corners) {
  double nearest = 1e9;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, cv::norm(corners[i] - corners[k]));
  const int half = std::clamp(static_cast<int>(clear * nearest), 2, 11);
  const cv::TermCriteria until(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-3);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1}, until);
}

bool findChessboard(const cv::Mat& grey, int columns, int rows, bool fast, std::vector<cv::Point2f>& corners) {
  const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | (fast ? cv::CALIB_CB_FAST_CHECK : 0);
  return cv::findChessboardCorners(grey, {columns, rows}, corners, flags);
}

std::vector<BoardCorner> chessboardIn(const cv::Mat& grey, const Board& board) {
  std::vector<cv::Point2f> corners;
  if (!findChessboard(grey, board.columns, board.rows, false, corners)) return {};
  refine(grey, 1.0 / 3, corners);
  std::vector<BoardCorner> found;
  for (std::size_t i = 0; i < corners.size(); ++i)
    found.push_back({static_cast<int>(i), {corners[i].x, corners[i].y}});
  return found;
}

std::vector<BoardCorner> charucoIn(const cv::Mat& grey, const Board& board) {
  const auto dictionary = cv::aruco::getPredefinedDictionary(dictionaries().at(board.dictionary));
  const auto printed = cv::aruco::CharucoBoard::create(board.columns, board.rows, static_cast<float>(board.squareM),
                                                       static_cast<float>(board.markerM), dictionary);
  std::vector<std::vector<cv::Point2f>> markers, rejected;
  std::vector<int> ids;
  const auto parameters = cv::aruco::DetectorParameters::create();
  cv::aruco::detectMarkers(grey, dictionary, markers, ids, parameters, rejected);
  cv::aruco::refineDetectedMarkers(grey, printed, markers, ids, rejected);
  if (ids.empty()) return {};
  std::vector<cv::Point2f> corners;
  std::vector<int> cornerIds;
  cv::aruco::interpolateCornersCharuco(markers, ids, grey, printed, corners, cornerIds);
  if (corners.size() < 4) return {};
  // OpenCV 4.6 gives these corners from the top-left pixel's own corner, and refines them in a fixed window.
  for (cv::Point2f& corner : corners) corner -= cv::Point2f(0.5f, 0.5f);
  refine(grey, std::min(1.0 / 3, 0.5 * (1 - board.markerM / board.squareM)), corners);
  std::vector<BoardCorner> found;
  for (std::size_t i = 0; i < corners.size(); ++i) found.push_back({cornerIds[i], {corners[i].x, corners[i].y}});
  return found;
}

}  // namespace

const std::vector<std::string>& markerDictionaries() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> made;
    for (const auto& [name, value] : dictionaries()) made.push_back(name);
    return made;
  }();
  return names;
}

Image<unsigned char> greyOf(const ColourImage& picture) {
  Image<unsigned char> grey(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const Rgba8 c = picture.data()[i];
    grey.data()[i] = static_cast<unsigned char>((299 * c.r + 587 * c.g + 114 * c.b + 500) / 1000);
  }
  return grey;
}

Result<std::vector<BoardCorner>> findBoard(const Image<unsigned char>& grey, const Board& board) {
  if (grey.empty()) return std::vector<BoardCorner>{};
  try {
    return board.kind == BoardKind::Chessboard ? chessboardIn(viewOf(grey), board) : charucoIn(viewOf(grey), board);
  } catch (const std::exception& error) {
    return fail(std::string("The search for the board broke off: ") + error.what(), {}, "Leave the picture out");
  }
}

std::optional<Board> chessboardNear(const Image<unsigned char>& grey, const Board& board) {
  if (board.kind != BoardKind::Chessboard || grey.empty()) return std::nullopt;
  try {
    for (const auto& [byColumns, byRows] : {std::pair{-1, -1}, {-1, 0}, {0, -1}, {1, 0}, {0, 1}, {1, 1}}) {
      Board other = board;
      other.columns += byColumns, other.rows += byRows;
      std::vector<cv::Point2f> corners;
      if (other.columns >= 3 && other.rows >= 3 && findChessboard(viewOf(grey), other.columns, other.rows, true, corners))
        return other;
    }
  } catch (const std::exception&) {
    // Advice only.
  }
  return std::nullopt;
}

}  // namespace alidade
