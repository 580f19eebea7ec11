// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/progress.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace alidade {

TEST(Progress, APartMapsOntoItsShareOfTheWhole) {
  double seen = -1;
  const Progress whole([&](double fraction, std::string_view) { seen = fraction; });
  whole.part(0.5, 0.9).part(0.0, 0.5).report(1.0, "");
  EXPECT_DOUBLE_EQ(seen, 0.7);
}

TEST(Progress, CancellingAPartCancelsTheWhole) {
  const Progress whole;
  whole.part(0, 0.5).cancel();
  EXPECT_TRUE(whole.cancelled());
}

TEST(Error, SaysWhatWhereAndWhatToDo) {
  const Error error{"The header promises 12 points, the file holds 7", "offset 107", "Copy the file again"};
  EXPECT_EQ(error.in("a.las").text(),
            "The header promises 12 points, the file holds 7 (a.las, offset 107). Copy the file again");
}

}  // namespace alidade
