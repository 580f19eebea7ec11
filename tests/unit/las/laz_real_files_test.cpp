// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// LAZ files of other programs against the same points in LAS, where they are at hand.

#include <filesystem>

#include <gmock/gmock.h>

#include "unit/las/all_points.h"

namespace fs = std::filesystem;
using alidade::LasReader;
using alidade::testing::AllPoints;
using alidade::testing::expectSamePoints;
using alidade::testing::readEverything;

namespace {

const fs::path kData(ALIDADE_SHARED_DATA_DIR);

#define NEED_SHARED_DATA() \
  if (!fs::exists(kData / "las")) GTEST_SKIP() << "SKIPPED: no real data at " << kData

}  // namespace

TEST(LazRealFiles, EveryPointEqualsTheUncompressedSiblingBitForBit) {
  NEED_SHARED_DATA();
  const std::vector<std::pair<const char*, const char*>> pairs = {
      {"las/las-rs/point10.laz", "las/las-rs/point10.las"},
      {"las/las-rs/point-time.laz", "las/las-rs/point-time.las"},
      {"las/las-rs/point-color.laz", "las/las-rs/point-color.las"},
      {"las/las-rs/point-time-color.laz", "las/las-rs/point-time-color.las"},
      {"las/las-rs/extra-bytes.laz", "las/las-rs/extra-bytes.las"},
      {"las/las-rs/point-version-1-point-wise.laz", "las/las-rs/point-version-1-point-wise.las"},
      {"las/laspy/1_4_w_evlr.laz", "las/laspy/1_4_w_evlr.las"},
      {"las/laspy/simple.laz", "las/laspy/simple.las"},
      {"las/laspy/extra.laz", "las/laspy/extrabytes.las"},
      {"las/pdal/simple-laszip-compressor-version-1.2r0.laz", "las/pdal/simple.las"}};
  for (const auto& [laz, las] : pairs) {
    const AllPoints packed = readEverything((kData / laz).string()), plain = readEverything((kData / las).string());
    EXPECT_EQ(packed.error, "") << laz;
    EXPECT_GT(plain.all.size(), 0u) << las;
    expectSamePoints(packed.all, plain.all, laz);
  }
}

TEST(LazRealFiles, EveryCompressedFileIsReadWithItsCountAndItsBounds) {
  NEED_SHARED_DATA();
  int read = 0;
  for (const char* folder : {"las", "copc"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kData / folder)) {
      if (entry.path().extension() != ".laz") continue;
      const auto info = LasReader().inspect(entry.path().string());
      ASSERT_TRUE(info.has_value()) << info.error().text();
      const AllPoints points = readEverything(entry.path().string());
      EXPECT_EQ(points.error, "");
      EXPECT_EQ(points.all.size(), info->pointCount) << entry.path();
      for (const auto& warning : points.warnings)
        EXPECT_THAT(warning.what, ::testing::Not(::testing::HasSubstr("bounds"))) << entry.path();
      ++read;
    }
  }
  EXPECT_GE(read, 15);
}
