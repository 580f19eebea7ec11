// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Files of other programs (las-rs, laspy, PDAL; road and room data sets), where they are at hand.

#include <algorithm>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>

#include "las/las_reader.h"

namespace fs = std::filesystem;
using alidade::Bounds;
using alidade::LasReader;
using alidade::PointBatch;
using alidade::Progress;

namespace {

const fs::path kData(ALIDADE_SHARED_DATA_DIR);

#define NEED_SHARED_DATA() \
  if (!fs::exists(kData / "las")) GTEST_SKIP() << "SKIPPED: no real data at " << kData

std::vector<fs::path> uncompressedFiles() {
  std::vector<fs::path> files = {kData / "road/road_mesh_sampled.las", kData / "indoor_video/cloud_quarter.las"};
  for (const auto& entry : fs::recursive_directory_iterator(kData / "las"))
    if (entry.path().extension() == ".las") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

PointBatch readAll(const fs::path& path, std::string* warnings = nullptr) {
  PointBatch all;
  const auto outcome = LasReader().read(
      path.string(),
      [&](const PointBatch& batch) {
        all.position.insert(all.position.end(), batch.position.begin(), batch.position.end());
        all.rgb.insert(all.rgb.end(), batch.rgb.begin(), batch.rgb.end());
        all.intensity.insert(all.intensity.end(), batch.intensity.begin(), batch.intensity.end());
        all.gpsTime.insert(all.gpsTime.end(), batch.gpsTime.begin(), batch.gpsTime.end());
        all.pointSource.insert(all.pointSource.end(), batch.pointSource.begin(), batch.pointSource.end());
        all.classification.insert(all.classification.end(), batch.classification.begin(),
                                  batch.classification.end());
        return true;
      },
      Progress());
  EXPECT_TRUE(outcome.has_value()) << path << ": " << outcome.error().text();
  if (outcome && warnings != nullptr) {
    for (const auto& warning : *outcome) *warnings += warning.what + "\n";
  }
  return all;
}

}  // namespace

TEST(LasRealFiles, CountsAndBoundsEqualTheHeaders) {
  NEED_SHARED_DATA();
  // simple1_3 has the bounds of unscaled integers in its header; cloud_quarter and road_mesh_sampled
  // those of what they are samples of; 1.2-no-points promises 1065 points and holds none.
  int checked = 0;
  for (const auto& path : uncompressedFiles()) {
    if (path.filename() == "1.2-no-points.las") continue;
    const auto info = LasReader().inspect(path.string());
    ASSERT_TRUE(info.has_value()) << path << ": " << info.error().text();
    std::string warnings;
    const PointBatch all = readAll(path, &warnings);
    EXPECT_EQ(all.size(), info->pointCount) << path;
    if (all.size() == 0) continue;
    if (path.filename() == "simple1_3.las") {
      EXPECT_THAT(warnings, ::testing::HasSubstr("outside the header's bounds"));
      continue;
    }
    EXPECT_THAT(warnings, ::testing::Not(::testing::HasSubstr("bounds"))) << path;
    const bool sample = path.parent_path().filename() == "road" || path.parent_path().filename() == "indoor_video";
    Bounds bounds;
    for (const auto& p : all.position) bounds.add(p);
    for (int axis = 0; axis < 3; ++axis) {
      const double slack = sample ? 0.1 : 0.51 * info->scale[axis];
      EXPECT_NEAR(bounds.min[axis], info->bounds.min[axis], slack) << path << " axis " << axis;
      EXPECT_NEAR(bounds.max[axis], info->bounds.max[axis], slack) << path << " axis " << axis;
    }
    ++checked;
  }
  EXPECT_GE(checked, 20);
}

TEST(LasRealFiles, AHeaderThatPromisesPointsWhereThereAreNoneIsRefused) {
  NEED_SHARED_DATA();
  const auto info = LasReader().inspect((kData / "las/pdal/permutations/1.2-no-points.las").string());
  ASSERT_FALSE(info.has_value());
  EXPECT_THAT(info.error().text(), ::testing::HasSubstr("promises 1065 points, the file holds 0"));
}

TEST(LasRealFiles, TheFirstPointOfSimpleLasIsTheOneThatPdalPublishes) {
  NEED_SHARED_DATA();
  // PDAL, test/unit/io/LasReaderTest.cpp and Support.cpp (check_p0).
  const PointBatch all = readAll(kData / "las/pdal/simple.las");
  ASSERT_EQ(all.size(), 1065u);
  EXPECT_NEAR(all.position[0].x, 637012.240000, 1e-6);
  EXPECT_NEAR(all.position[0].y, 849028.310000, 1e-6);
  EXPECT_NEAR(all.position[0].z, 431.660000, 1e-6);
  EXPECT_EQ(all.rgb[0], glm::u16vec3(68, 77, 88));
  EXPECT_NEAR(all.gpsTime[0], 245380.78254962614, 1e-9);
}

TEST(LasRealFiles, TheSamePointsStandInEveryCoding) {
  NEED_SHARED_DATA();
  const std::vector<std::vector<const char*>> groups = {
      {"laspy/simple.las", "pdal/simple.las", "las-rs/extra-bytes.las", "laspy/extrabytes.las"},
      {"las-rs/point-time-color.las", "las-rs/point10.las", "las-rs/point-time.las", "las-rs/point-color.las"}};
  for (const auto& group : groups) {
    const PointBatch truth = readAll(kData / "las" / group.front());
    for (const char* name : group) {
      const PointBatch all = readAll(kData / "las" / name);
      ASSERT_EQ(all.size(), truth.size()) << name;
      EXPECT_TRUE(all.position == truth.position) << name;
      EXPECT_TRUE(all.intensity == truth.intensity) << name;
      EXPECT_TRUE(all.pointSource == truth.pointSource) << name;
      EXPECT_TRUE(all.gpsTime.empty() || all.gpsTime == truth.gpsTime) << name;
      EXPECT_TRUE(all.rgb.empty() || all.rgb == truth.rgb) << name;
    }
  }
}

TEST(LasRealFiles, TheWktBitDecidesInAFileWithBothSystems) {
  NEED_SHARED_DATA();
  const auto info = LasReader().inspect((kData / "las/laspy/file_with_both_wkt_and_geotiff_vlrs.las").string());
  ASSERT_TRUE(info.has_value());
  EXPECT_THAT(info->crs, ::testing::AnyOf(::testing::StartsWith("PROJC"), ::testing::StartsWith("COMPD"),
                                          ::testing::StartsWith("EPSG:")));
  const auto degrees = LasReader().inspect((kData / "las/pdal/test_epsg_4326.las").string());
  ASSERT_TRUE(degrees.has_value());
  EXPECT_EQ(degrees->crs, "EPSG:4326");
}
