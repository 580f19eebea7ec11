// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/ptx_reader.h"

#include <filesystem>

#include <gmock/gmock.h>

#include "unit/ply/scan_reading.h"

namespace fs = std::filesystem;
using namespace alidade;
using alidade::testing::readScan;
using alidade::testing::TemporaryFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const fs::path kData = fs::path(ALIDADE_SHARED_DATA_DIR) / "text_and_ply/ptx";

std::string head(const std::string& columns, const std::string& rows, const std::string& translation = "10 20 30") {
  // A quarter turn: local x is world y, local y is world -x.
  return columns + "\n" + rows + "\n0 0 0\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n" + translation + " 1\n";
}

std::string errorOf(const std::string& text) {
  const TemporaryFile file("broken.ptx", text);
  const std::string error = readScan(PtxReader(), file.path()).error;
  EXPECT_THAT(error, HasSubstr("broken.ptx"));
  return error;
}

}  // namespace

TEST(PtxReader, PointsKeepTheirPlaceInTheGridAndAreTurnedIntoTheWorld) {
  const TemporaryFile file("two.ptx", head("2", "3") +
                           "1 0 0 0.5 255 0 7\n0 0 0 0.5 0 0 0\n0 1 5 1 1 2 3\r\n0 0 0 0.5\n2 0 0 0 9 9 9\n0 0 0 0.5 0 0 0\n" +
                           head("1", "1", "0 0 0") + "1 2 3 0.25\n");
  std::vector<PointBatch> batches;
  const auto done = PtxReader().read(file.path(), [&](PointBatch& b) { batches.push_back(b); return true; }, Progress());
  ASSERT_TRUE(done) << done.error().text();
  ASSERT_EQ(batches.size(), 2u);
  EXPECT_THAT(batches[0].position, ElementsAre(glm::dvec3(10, 21, 30), glm::dvec3(9, 20, 35), glm::dvec3(10, 22, 30)));
  EXPECT_THAT(batches[0].column, ElementsAre(0, 0, 1));
  EXPECT_THAT(batches[0].row, ElementsAre(0, 2, 1));
  EXPECT_THAT(batches[0].rgb, ElementsAre(glm::u16vec3(255, 0, 7), glm::u16vec3(1, 2, 3), glm::u16vec3(9, 9, 9)));
  EXPECT_THAT(batches[0].intensity, ElementsAre(32768, 65535, 0));
  EXPECT_THAT(batches[0].scanner, ElementsAre(0, 0, 0));
  EXPECT_THAT(batches[1].position, ElementsAre(glm::dvec3(-2, 1, 3)));
  EXPECT_TRUE(batches[1].rgb.empty());
  EXPECT_THAT(batches[1].scanner, ElementsAre(1));
  ASSERT_EQ(batches[0].extra.size(), 1u);
  EXPECT_EQ(numberAt(batches[0].extra[0].data.data(), NumberType::F32), 0.5);
  EXPECT_THAT((*done)[0].what, HasSubstr("3 directions without a return"));

  const auto info = PtxReader().inspect(file.path());
  ASSERT_TRUE(info);
  EXPECT_EQ(info->pointCount, 7u);
  ASSERT_EQ(info->stations.size(), 2u);
  EXPECT_EQ(info->stations[0].rows, 3u);
  EXPECT_EQ(info->stations[0].columns, 2u);
  EXPECT_EQ(info->stations[0].worldFromScanner.translation, glm::dvec3(10, 20, 30));
  EXPECT_NEAR(glm::length(info->stations[0].worldFromScanner * glm::dvec3(1, 0, 0) - glm::dvec3(10, 21, 30)), 0, 1e-12);
}

TEST(PtxReader, BrokenFilesAreRefusedWithTheirLine) {
  EXPECT_THAT(errorOf(""), HasSubstr("empty"));
  EXPECT_THAT(errorOf("2\n2\n0 0 0\n"), HasSubstr("ends within a scan's header"));
  EXPECT_THAT(errorOf("two\n2\n"), HasSubstr("'two' is no number of columns (/"));
  EXPECT_THAT(errorOf(head("2", "-1")), HasSubstr("no number of rows"));
  EXPECT_THAT(errorOf(head("2", "2", "nan 0 0")), HasSubstr("not finite"));
  EXPECT_THAT(errorOf(head("2000000000", "2000000000")), HasSubstr("room for"));
  EXPECT_THAT(errorOf(head("1", "2") + "1 2 3 0.12345678\n"), HasSubstr("ends after 1 of 2"));
  EXPECT_THAT(errorOf(head("1", "2") + "1 2 3 0.5\n1 2 3\n           \n"), HasSubstr("3 numbers, not 4 or 7"));
  EXPECT_THAT(errorOf(head("1", "2") + "1 2 3 0.5\n1 2 x 4\n"), HasSubstr("line 12"));
  EXPECT_THAT(errorOf("1\n1\n0 0 0\n0 1\n"), HasSubstr("line 4"));
}

TEST(PtxReader, SharedFilesHoldTheSamePointsWhateverTheirTransform) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const auto plain = readScan(PtxReader(), (kData / "1.2-with-color.ptx").string());
  ASSERT_EQ(plain.all.size(), 1065u) << plain.error;
  EXPECT_EQ(plain.all.position[0], glm::dvec3(637012.24, 849028.31, 431.66));
  EXPECT_EQ(plain.all.rgb[0], glm::u16vec3(68, 77, 88));
  EXPECT_EQ(plain.all.column[71], 1u);
  EXPECT_EQ(plain.all.row[70], 70u);
  // PDAL's own sibling: the first four points, scaled and shifted, then as they are.
  const auto twice = readScan(PtxReader(), (kData / "multiple-and-transform.ptx").string());
  ASSERT_EQ(twice.all.size(), 8u) << twice.error;
  EXPECT_THAT(twice.warnings, HasSubstr("no rigid motion"));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(glm::length(twice.all.position[i] - plain.all.position[i]), 0, 1e-6) << i;
    EXPECT_EQ(twice.all.position[i + 4], plain.all.position[i]) << i;
  }
  // CloudCompare 2.11's answer, which has float's digits.
  const auto turned = readScan(PtxReader(), (kData / "complex-transform.ptx").string());
  ASSERT_EQ(turned.all.size(), 4u) << turned.error;
  EXPECT_NEAR(glm::length(turned.all.position[0] - glm::dvec3(-3.034407616, -3.173781395, -1.823750138)), 0, 2e-6);
  EXPECT_NEAR(glm::length(turned.all.position[2] - glm::dvec3(-3.034365892, -3.168530226, -1.825114727)), 0, 2e-6);
  EXPECT_THAT(turned.all.column, ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(turned.all.row, ElementsAre(4, 5, 0, 1));
}
