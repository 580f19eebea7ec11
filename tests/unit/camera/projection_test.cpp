// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include "camera/camera.h"

namespace alidade {
namespace {

TEST(Projection, RoadCameraFoldsBackAtItsPublishedRadius) {
  const auto in = Intrinsics::fromParameters(
      CameraModel::OpenCv8, 5472, 3648,
      {3693.1569475809993, 3693.1569475809993, 2731.4405, 1846.4932, -0.26439037908330026, 0.10751677446162797,
       -0.000503346062832222, -0.0005062622264917514, -0.030410562029402437, 0, 0, 0});
  ASSERT_TRUE(in);
  const Camera camera(*in);
  EXPECT_NEAR(camera.foldBackRadius(), 1.369, 0.0005);
  EXPECT_LT(camera.imageRadius(), camera.foldBackRadius());
  EXPECT_FALSE(camera.project({1.38, 0, 1}));
  EXPECT_TRUE(camera.project({1.36, 0, 1}));
}

}  // namespace
}  // namespace alidade
