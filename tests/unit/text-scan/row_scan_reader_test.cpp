// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/row_scan_reader.h"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>

#include "unit/ply/scan_reading.h"

namespace fs = std::filesystem;
using namespace alidade;
using alidade::testing::readScan;
using alidade::testing::ScanReading;
using alidade::testing::TemporaryFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const fs::path kData = fs::path(ALIDADE_SHARED_DATA_DIR) / "text_and_ply";

ScanReading readXyz(const std::string& text) {
  const TemporaryFile file("list.xyz", text);
  return readScan(XyzReader(), file.path());
}

ScanReading readPts(const std::string& text) {
  const TemporaryFile file("list.pts", text);
  return readScan(PtsReader(), file.path());
}

int sniffed(const ScanReader& reader, const std::string& name, const std::string& text) {
  const auto dot = name.rfind('.');
  return reader.sniff({name, name.substr(dot + 1), false, std::as_bytes(std::span(text))});
}

const glm::dvec3 kFirst(1.5, -2.25, 3), kSecond(4, 5.5, 6);

}  // namespace

TEST(PointLists, AnySeparatorAndDecimalSignGivesTheSamePoints) {
  for (const char* text : {"1.5 -2.25 3\n4 5.5 6\n", "1.5\t-2.25\t3\n4\t5.5\t6", "1.5,-2.25,3\r\n4,5.5,6\r\n", "1.5, -2.25, 3\n4, 5.5, 6\n",
                           "1.5;-2.25;3\n4;5.5;6\n", "1,5;-2,25;3\n4;5,5;6\n", "1,5 -2,25 3,0\n4 5,5 6,0\n", "1,5\t-2,25\t3\n4\t5,5\t6\n",
                           "  1.5   -2.25 3  \n\n# remark\n4 +5.5 6e0\n", "\xEF\xBB\xBF" "1.5 -2.25 3\n4 5.5 6\n", "2\n1.5 -2.25 3\n4 5.5 6\n",
                           "1.5 -2.25 3\r4 5.5 6\r"}) {
    const auto reading = readXyz(text);
    EXPECT_THAT(reading.all.position, ElementsAre(kFirst, kSecond)) << text << reading.error;
  }
}

TEST(PointLists, HeadersAndRemarksNameTheColumns) {
  const std::string rows = "7 1.5 -2.25 3 10 20 30 0.5\n8 4 5.5 6 11 21 31 0.25\n";
  for (const char* header : {"class x y z r g b quality\n", "//class X Y Z R G B quality\n", "# columns: class x y z r g b quality\n",
                             "# made by hand\nClassification East North Height Red Green Blue quality\n"}) {
    const auto reading = readXyz(header + rows);
    EXPECT_THAT(reading.all.position, ElementsAre(kFirst, kSecond)) << header << reading.error;
    EXPECT_THAT(reading.all.rgb, ElementsAre(glm::u16vec3(10, 20, 30), glm::u16vec3(11, 21, 31)));
    EXPECT_THAT(reading.all.classification, ElementsAre(7, 8));
    EXPECT_THAT(reading.warnings, HasSubstr("named as class, x, y, z, red, green, blue (0 to 255), 'quality'"));
  }
  const TemporaryFile file("extra.xyz", "# columns: - x y z i - - quality\n" + rows);
  std::vector<ExtraColumn> extra;
  ASSERT_TRUE(XyzReader().read(file.path(), [&](PointBatch& b) { extra = b.extra; return true; }, Progress()));
  ASSERT_EQ(extra.size(), 2u);  // the raw intensity and the maker's own
  EXPECT_EQ(extra[0].name, "intensity");
  EXPECT_EQ(numberAt(extra[0].data.data(), extra[0].type), 10);
  EXPECT_EQ(extra[1].name, "quality");
  EXPECT_EQ(numberAt(extra[1].data.data() + 8, extra[1].type), 0.25);
}

TEST(PointLists, ColumnsAreGuessedFromCountAndRange) {
  const auto colour = readXyz("0 0 0 200 100 7\n1 1 1 0 0 0\n");
  EXPECT_THAT(colour.all.rgb, ElementsAre(glm::u16vec3(200, 100, 7), glm::u16vec3(0, 0, 0)));
  EXPECT_THAT(colour.warnings, HasSubstr("taken as x, y, z, red, green, blue (0 to 255)"));
  const auto deep = readXyz("0 0 0 65535 0 256\n");
  EXPECT_THAT(deep.all.rgb, ElementsAre(glm::u16vec3(65535, 0, 256)));
  const auto share = readXyz("0 0 0 1 0.5 0.2\n0 0 0 0 0 1\n");
  EXPECT_THAT(share.all.rgb, ElementsAre(glm::u16vec3(255, 128, 51), glm::u16vec3(0, 0, 255)));
  const auto normals = readXyz("0 0 0 0.6 0 -0.8\n0 0 0 0 1 0\n");
  EXPECT_TRUE(normals.all.rgb.empty());
  ASSERT_EQ(normals.all.normal.size(), 2u);
  EXPECT_NEAR(normals.all.normal[0].z, -0.8, 1e-6);
  const auto seven = readXyz("0 0 0 55 1 2 3\n0 0 0 255 4 5 6\n");
  EXPECT_THAT(seven.all.rgb, ElementsAre(glm::u16vec3(1, 2, 3), glm::u16vec3(4, 5, 6)));
  EXPECT_THAT(seven.all.intensity, ElementsAre(55 * 257, 65535));
  const auto swapped = readXyz("0 0 0 1 2 3 4000.5\n0 0 0 4 5 6 65535\n");
  EXPECT_THAT(swapped.all.rgb, ElementsAre(glm::u16vec3(1, 2, 3), glm::u16vec3(4, 5, 6)));
  EXPECT_THAT(swapped.all.intensity, ElementsAre(4001, 65535));
  EXPECT_THAT(readXyz("0 0 0 0.5\n0 0 0 1\n").all.intensity, ElementsAre(32768, 65535));
}

TEST(PointLists, PtsKeepsItsOrderCountsAndIntensityConvention) {
  const auto reading = readPts("2\n1.5 -2.25 3 -2048 1 2 3\n4 5.5 6 2047 4 5 6\n1\n0 0 0 0 0 0 0\n");
  EXPECT_EQ(reading.all.size(), 3u) << reading.error;
  EXPECT_THAT(reading.all.intensity, ElementsAre(0, 65535, 32776));  // 2048 / 4095 of 65535
  EXPECT_THAT(reading.all.rgb, ElementsAre(glm::u16vec3(1, 2, 3), glm::u16vec3(4, 5, 6), glm::u16vec3(0, 0, 0)));
  EXPECT_THAT(readPts("1\n0 0 0\n1 1 1\n").warnings, HasSubstr("says that it has 1 points; it has 2"));
  EXPECT_THAT(readPts("3\n0 0 0\n1 1 1\n").error, HasSubstr("ends after 2 of 3"));
  EXPECT_EQ(readPts("0\n").error, "");
}

TEST(PointLists, BrokenListsAreRefusedWithTheirLine) {
  EXPECT_THAT(readXyz("1 2 3\n1 2 three\n").error, HasSubstr("'three' is no number (/"));
  EXPECT_THAT(readXyz("1 2 3\n1 2 three\n").error, HasSubstr("line 2"));
  EXPECT_THAT(readXyz("1 2 3\n\n# r\n1 2\n").error, HasSubstr("The row has 2 numbers, those before have 3"));
  EXPECT_THAT(readXyz("1 2 3\n\n# r\n1 2\n").error, HasSubstr("line 4"));
  EXPECT_THAT(readXyz("hello world\n").error, HasSubstr("'hello' is no number"));
  EXPECT_THAT(readXyz("x y z i\n1 2 3\n").error, HasSubstr("names 4 columns, the rows have 3"));
  EXPECT_THAT(readXyz("1 2\n").error, HasSubstr("less than three"));
  EXPECT_THAT(readXyz(std::string("1 2 3\n1 \0 3\n", 12)).error, HasSubstr("zero byte"));
  EXPECT_THAT(readXyz("1 2 3\n" + std::string(70000, '1') + "\n").error, HasSubstr("longer than"));
  EXPECT_THAT(readXyz("\xff\xfe" "1 2 3").error, HasSubstr("UTF-16"));
  EXPECT_THAT(readPts("99999999999\n1 2 3\n").error, HasSubstr("more than it has bytes"));
  EXPECT_THAT(readXyz("nan 1 2\n1 2 3\n").warnings, HasSubstr("1 points without usable coordinates"));
}

TEST(PointLists, StakeOutListsAreLeftToTheirOwnReader) {
  EXPECT_EQ(sniffed(XyzReader(), "stake.csv", "name,E,N,H,code,tolerance\nMH1,2683500.2421,1247790.2275,411.6273,MANHOLE,0.02\n"), 0);
  EXPECT_EQ(sniffed(XyzReader(), "o.csv", "u,v,e,n,h\n1,2,3,4,5\n"), 0);
  EXPECT_LT(sniffed(XyzReader(), "p.csv", "E,N,H\n1,2,3\n"), 65);        // the stake reader's claim on a header
  EXPECT_LT(sniffed(XyzReader(), "p.csv", "1,2683500.2,1247790.2,411.6\n"), 45);  // and on name, E, N, H
  EXPECT_GT(sniffed(XyzReader(), "c.csv", "x,y,z,intensity\n1,2,3,4\n"), 65);
  EXPECT_GT(sniffed(XyzReader(), "c.csv", "1,2,3,44,55,66\n"), 45);
  EXPECT_GT(sniffed(XyzReader(), "c.asc", "1 2 3\n"), 50);
  EXPECT_EQ(sniffed(XyzReader(), "c.txt", "1 PINHOLE 640 480\n"), 0);
  EXPECT_GT(sniffed(PtsReader(), "c.pts", "2\n1 2 3\n"), 50);
}

TEST(PointLists, SharedPtsFilesGiveTheirOwnLines) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const auto read = [](const char* name) { return readScan(PtsReader(), (kData / "pts" / name).string()); };
  const auto autzen = read("autzen.pts");
  ASSERT_EQ(autzen.all.size(), 10u) << autzen.error;
  EXPECT_EQ(autzen.all.position[9], glm::dvec3(636125.879990, 848971.060013, 428.050003));
  EXPECT_EQ(autzen.all.rgb[9], glm::u16vec3(114, 127, 100));
  EXPECT_EQ(autzen.all.intensity[0], std::lround((2048 - 1613) / 4095.0 * 65535));
  EXPECT_EQ(read("test.pts").all.size(), 19u);
  EXPECT_EQ(read("site_56_8.pts").all.intensity.size(), 8u);
  EXPECT_THAT(read("bunny_8.pts").warnings, HasSubstr("says that it has 8 points; it has 9"));
}
