// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gmock/gmock.h>

#include "targets/board.h"

namespace alidade {
namespace {

using testing::HasSubstr;

TEST(Board, IsReadFromWordsAndSaidBack) {
  const auto chessboard = Board::parse("chessboard:8x6:0.025");
  ASSERT_TRUE(chessboard);
  EXPECT_EQ(chessboard->corners().size(), 48u);
  EXPECT_EQ(chessboard->corners()[9], glm::dvec3(0.025, 0.025, 0));
  EXPECT_EQ(chessboard->text(), "chessboard:8x6:0.025");
  const auto charuco = Board::parse("charuco:7x5:0.04:0.03:DICT_5X5_100");
  ASSERT_TRUE(charuco);
  EXPECT_EQ(charuco->corners().size(), 24u);
  EXPECT_EQ(charuco->text(), "charuco:7x5:0.04:0.03:DICT_5X5_100");
}

TEST(Board, WhatCannotBeIsRefusedByName) {
  const auto what = [](const char* text) { return Board::parse(text).error().what; };
  EXPECT_THAT(what(""), HasSubstr("There is no board ''"));
  EXPECT_THAT(what("circles:4x11:0.02"), HasSubstr("There is no board 'circles'"));
  EXPECT_THAT(what("chessboard:8x6"), HasSubstr("3 parts, 2 were given"));
  EXPECT_THAT(what("chessboard:8:0.02"), HasSubstr("size '8'"));
  EXPECT_THAT(what("chessboard:8x999999999999:0.02"), HasSubstr("size '8x999999999999'"));
  EXPECT_THAT(what("chessboard:8x6:0"), HasSubstr("no length"));
  EXPECT_THAT(what("chessboard:8x6:nan"), HasSubstr("no length"));
  EXPECT_THAT(what("charuco:7x5:0.03:0.04:DICT_5X5_100"), HasSubstr("below the square's"));
  EXPECT_THAT(what("charuco:7x5:0.04:0.03:DICT_9X9_1"), HasSubstr("no marker dictionary"));
  EXPECT_THAT(what("charuco:12x12:0.04:0.03:DICT_4X4_50"), HasSubstr("72 markers, DICT_4X4_50 only 50"));
}

}  // namespace
}  // namespace alidade
