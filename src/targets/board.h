// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"

namespace alidade {

enum class BoardKind {
  Chessboard,  ///< black and white squares; seen whole or not at all
  Charuco,     ///< a chessboard with ArUco markers in its white squares; parts of it suffice
};

/// A flat calibration board, as it was printed.
struct Board {
  BoardKind kind = BoardKind::Chessboard;
  int columns = 0, rows = 0;  ///< of a chessboard: inner corners; of a ChArUco board: squares
  double squareM = 0;         ///< side of a square
  double markerM = 0;         ///< side of a ChArUco board's markers
  std::string dictionary;     ///< of its markers: "DICT_5X5_100"

  /// "chessboard:8x6:0.025" (inner corners, square in metres) or "charuco:7x5:0.04:0.03:DICT_5X5_100"
  /// (squares, square and marker in metres, OpenCV's dictionary).
  static Result<Board> parse(const std::string& text);
  std::string text() const;

  /// Inner corners along x and y.
  int cornerColumns() const { return kind == BoardKind::Chessboard ? columns : columns - 1; }
  int cornerRows() const { return kind == BoardKind::Chessboard ? rows : rows - 1; }
  /// Inner corners on the board's plane z = 0, row by row, metres; the first at (0, 0).
  std::vector<glm::dvec3> corners() const;
};

/// An inner corner of a board found in a picture.
struct BoardCorner {
  int corner = 0;       ///< index into Board::corners()
  glm::dvec2 pixel{0};  ///< OpenCV's origin, to a fraction of a pixel
};

/// The dictionaries of markers that a ChArUco board can have.
const std::vector<std::string>& markerDictionaries();

}  // namespace alidade
