// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/image.h"
#include "targets/board.h"

namespace alidade {

/// Luminance of a colour picture (ITU-R BT.601).
Image<unsigned char> greyOf(const ColourImage& picture);

/// The board's corners by OpenCV 4.6 (findChessboardCorners, or the ArUco markers and the corners between
/// them), each then moved to where the grey gradients around it are all orthogonal to the way from it
/// (cornerSubPix), within a window that keeps clear of its neighbours. Empty where no board is seen.
Result<std::vector<BoardCorner>> findBoard(const Image<unsigned char>& grey, const Board& board);

/// A chessboard with one row or column more or fewer that the picture does show: for advice when the size
/// given was wrong.
std::optional<Board> chessboardNear(const Image<unsigned char>& grey, const Board& board);

}  // namespace alidade
