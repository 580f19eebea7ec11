// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/point_batch.h"

#include <gmock/gmock.h>

using namespace alidade;
using ::testing::ElementsAre;

namespace {

PointBatch fivePoints() {
  PointBatch batch;
  ExtraColumn extra{"quality", NumberType::U8, 2, {}};
  for (int i = 0; i < 5; ++i) {
    batch.position.push_back({i, 10 * i, 0});
    batch.rgb.push_back({i, 0, 65535});
    batch.gpsTime.push_back(i * 0.5);
    extra.data.push_back(static_cast<std::byte>(i));
    extra.data.push_back(static_cast<std::byte>(100 + i));
  }
  batch.rgbWhite = 65535;
  batch.extra.push_back(extra);
  return batch;
}

}  // namespace

TEST(PointBatch, ChosenPointsKeepAllTheirColumns) {
  const std::vector<std::uint32_t> indices = {3, 0, 3};
  const PointBatch some = fivePoints().chosen(indices);
  EXPECT_THAT(some.position, ElementsAre(glm::dvec3(3, 30, 0), glm::dvec3(0), glm::dvec3(3, 30, 0)));
  EXPECT_THAT(some.rgb, ElementsAre(glm::u16vec3(3, 0, 65535), glm::u16vec3(0, 0, 65535), glm::u16vec3(3, 0, 65535)));
  EXPECT_EQ(some.rgbWhite, 65535);
  EXPECT_THAT(some.gpsTime, ElementsAre(1.5, 0.0, 1.5));
  EXPECT_TRUE(some.intensity.empty());
  ASSERT_EQ(some.extra.size(), 1u);
  EXPECT_THAT(some.extra[0].data, ElementsAre(std::byte(3), std::byte(103), std::byte(0), std::byte(100), std::byte(3), std::byte(103)));
}

TEST(PointBatch, EveryNthPointStartsAtTheFirstAskedFor) {
  const PointBatch some = fivePoints().every(1, 2);
  EXPECT_THAT(some.gpsTime, ElementsAre(0.5, 1.5));
  EXPECT_EQ(some.extra[0].data.size(), 4u);
  EXPECT_EQ(fivePoints().every(5, 2).size(), 0u);
}
