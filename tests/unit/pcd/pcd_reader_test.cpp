// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pcd/pcd_reader.h"

#include <gmock/gmock.h>

#include "pcd/lzf.h"
#include "unit/ply/scan_reading.h"

namespace fs = std::filesystem;
using namespace alidade;
using alidade::testing::bytesOf;
using alidade::testing::readScan;
using alidade::testing::ScanReading;
using alidade::testing::TemporaryFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const fs::path kData = fs::path(ALIDADE_SHARED_DATA_DIR) / "text_and_ply/pcd";

std::string head(const std::string& data, int points, const std::string& width = {}) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb intensity\nSIZE 4 4 4 4 2\n"
         "TYPE F F F F U\nCOUNT 1 1 1 1 1\nWIDTH " + (width.empty() ? std::to_string(points) + "\nHEIGHT 1" : width) +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n";
}

float colourBits(std::uint32_t rgb) {
  float value;
  std::memcpy(&value, &rgb, 4);
  return value;
}

ScanReading readText(const std::string& content) {
  const TemporaryFile file("test.pcd", content);
  return readScan(PcdReader(), file.path());
}

std::string errorOf(const std::string& content) {
  const TemporaryFile file("broken.pcd", content);
  const ScanReading reading = readScan(PcdReader(), file.path());
  EXPECT_THAT(reading.error, HasSubstr(file.path()));
  EXPECT_TRUE(reading.all.position.empty());
  return reading.error;
}

/// LZF without any compression: literal runs of at most 32 bytes.
std::string literalLzf(const std::string& plain) {
  std::string packed;
  for (std::size_t at = 0; at < plain.size(); at += 32) {
    const std::string run = plain.substr(at, 32);
    packed += static_cast<char>(run.size() - 1) + run;
  }
  return packed;
}

std::string compressedFile(const std::string& packed, std::uint32_t plainSize, int points) {
  return head("binary_compressed", points) + bytesOf(static_cast<std::uint32_t>(packed.size())) + bytesOf(plainSize) + packed;
}

}  // namespace

TEST(PcdReader, TextBinaryAndCompressedGiveTheSamePoints) {
  const float x[] = {1.5f, -2.25f, 100.0f}, y[] = {7, 8, 9}, z[] = {0.125f, 0, -1};
  const std::uint32_t colour[] = {0x00FF8001, 0x00102030, 0x00000000};
  const std::uint16_t intensity[] = {65535, 0, 700};
  std::string text = head("ascii", 3), binary = head("binary", 3), columns;
  for (int i = 0; i < 3; ++i) {
    char line[200];
    std::snprintf(line, sizeof line, "%g %g %g %.9g %u\n", x[i], y[i], z[i], colourBits(colour[i]), intensity[i]);
    text += line;
    binary += bytesOf(x[i]) + bytesOf(y[i]) + bytesOf(z[i]) + bytesOf(colour[i]) + bytesOf(intensity[i]);
  }
  for (const auto& column : {x, y, z})
    for (int i = 0; i < 3; ++i) columns += bytesOf(column[i]);
  for (const auto each : colour) columns += bytesOf(each);
  for (const auto each : intensity) columns += bytesOf(each);
  const std::string compressed = compressedFile(literalLzf(columns), static_cast<std::uint32_t>(columns.size()), 3);

  for (const std::string& content : {text, binary, compressed}) {
    const auto reading = readText(content);
    EXPECT_THAT(reading.all.position,
                ElementsAre(glm::dvec3(1.5, 7, 0.125), glm::dvec3(-2.25, 8, 0), glm::dvec3(100, 9, -1)))
        << reading.error;
    EXPECT_THAT(reading.all.rgb,
                ElementsAre(glm::u16vec3(255, 128, 1), glm::u16vec3(16, 32, 48), glm::u16vec3(0, 0, 0)));
    EXPECT_THAT(reading.all.intensity, ElementsAre(65535, 0, 700));
  }
}

TEST(PcdReader, AnOrganisedCloudGivesRowsAndColumnsAndDropsWhatDidNotReturn) {
  const auto reading = readText(head("ascii", 6, "3\nHEIGHT 2") +
                                "0 0 0 0 1\nnan nan nan 0 1\n2 0 0 0 1\n0 1 0 0 1\n1 1 0 0 1\n2 1 0 0 1\n");
  ASSERT_EQ(reading.all.size(), 5u) << reading.error;
  EXPECT_THAT(reading.all.row, ElementsAre(0, 0, 1, 1, 1));
  EXPECT_THAT(reading.all.column, ElementsAre(0, 2, 0, 1, 2));
  EXPECT_THAT(reading.warnings, HasSubstr("1 points"));
}

TEST(Lzf, BackReferencesOverlapAndLyingOnesAreRefused) {
  const auto decode = [](std::vector<int> in, std::size_t size) -> std::string {
    std::vector<std::byte> bytes;
    for (const int each : in) bytes.push_back(static_cast<std::byte>(each));
    std::string out(size, '?');
    return decodeLzf(bytes, std::as_writable_bytes(std::span(out))) ? out : "refused";
  };
  EXPECT_EQ(decode({0, 'a', 0x20 << 1, 0}, 5), "aaaaa");          // 'a', then 4 from one back
  EXPECT_EQ(decode({1, 'a', 'b', 0xE0, 1, 1}, 12), "abababababab");  // length 7 + 1 + 2 from two back
  EXPECT_EQ(decode({0, 'a', 0x40, 1}, 5), "refused");             // from before the start
  EXPECT_EQ(decode({0, 'a', 0x40, 0}, 4), "refused");             // past the end
  EXPECT_EQ(decode({0, 'a', 0x40, 0}, 6), "refused");             // too little
  EXPECT_EQ(decode({5, 'a'}, 6), "refused");
  EXPECT_EQ(decode({0, 'a', 0x40}, 5), "refused");
  EXPECT_EQ(decode({0, 'a', 0xE0}, 5), "refused");
}

TEST(PcdReader, BrokenFilesAreRefusedWithTheirReason) {
  const std::string row = "1 2 3 0 4\n";
  EXPECT_THAT(errorOf(""), HasSubstr("no line DATA"));
  EXPECT_THAT(errorOf("1 2 3\n4 5 6\n"), HasSubstr("has no header"));
  EXPECT_THAT(errorOf("hello\n"), HasSubstr("hello"));
  EXPECT_THAT(errorOf("FIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"), HasSubstr("3 FIELDS, 2 SIZE"));
  EXPECT_THAT(errorOf("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"), HasSubstr("F3"));
  EXPECT_THAT(errorOf("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 99999999999\nPOINTS 1\nDATA binary\n"),
              HasSubstr("more than"));
  EXPECT_THAT(errorOf("FIELDS a b c\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"), HasSubstr("no x, y and z"));
  EXPECT_THAT(errorOf("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nDATA ascii\n1 2 3\n"), HasSubstr("neither POINTS nor WIDTH"));
  EXPECT_THAT(errorOf(head("ascii", 2) + row), HasSubstr("promises 2 points"));
  EXPECT_THAT(errorOf(head("ascii", 2) + "1.00000 2.00000 3.00000 0 4\n"), HasSubstr("ends after 1"));
  EXPECT_THAT(errorOf(head("ascii", 1) + "1 2 3      \n"), HasSubstr("too few numbers"));
  EXPECT_THAT(errorOf(head("ascii", 1) + "1 2 three 0 4\n"), HasSubstr("three"));
  EXPECT_THAT(errorOf(head("binary", 2) + std::string(35, 'x')), HasSubstr("room for 1"));
  EXPECT_THAT(errorOf(head("binary", 2000000000) + std::string(36, 'x')), HasSubstr("promises 2000000000"));
  EXPECT_THAT(errorOf(head("sideways", 1)), HasSubstr("sideways"));
  EXPECT_THAT(errorOf(compressedFile(literalLzf(std::string(36, 'x')), 35, 2)), HasSubstr("makes it 36"));
  EXPECT_THAT(errorOf(compressedFile(literalLzf(std::string(30, 'x')), 36, 2)), HasSubstr("damaged"));
  EXPECT_THAT(errorOf(head("binary_compressed", 2) + bytesOf(0xFFFFFFFFu) + bytesOf(36u) + std::string(40, 'x')),
              HasSubstr("4294967295"));
}

TEST(PcdReader, ContradictingCountsAndAViewpointAreWarnedOf) {
  std::string content = head("ascii", 2, "7\nHEIGHT 1") + "1 2 3 0 4\n1 2 3 0 4\n";
  content.replace(content.find("VIEWPOINT 0"), 11, "VIEWPOINT 5");
  const auto reading = readText(content);
  EXPECT_EQ(reading.all.size(), 2u) << reading.error;
  EXPECT_THAT(reading.warnings, HasSubstr("POINTS is 2"));
  EXPECT_THAT(reading.warnings, HasSubstr("VIEWPOINT"));
}

TEST(PcdReader, RealFilesKeepTheirDigitsWhateverPartsThem) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  for (const char* name : {"utm17_space.pcd", "utm17_tab.pcd", "utm17_comma.pcd"}) {
    const auto reading = readScan(PcdReader(), (kData / name).string());
    ASSERT_EQ(reading.all.size(), 10u) << name << reading.error;
    EXPECT_EQ(reading.all.position[0], glm::dvec3(289814.15, 4320978.61, 170.76)) << name;
    EXPECT_EQ(reading.all.position[9], glm::dvec3(289818.50, 4320980.59, 170.58)) << name;
  }
  EXPECT_THAT(readScan(PcdReader(), (kData / "missingheader.pcd").string()).error, HasSubstr("has no header"));
}

TEST(PcdReader, ABinaryFileOfPdalHoldsPlausiblePoints) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const auto reading = readScan(PcdReader(), (kData / "autzen-utm.pcd").string());
  ASSERT_EQ(reading.all.size(), 1065u) << reading.error;
  // The las-rs files are the same survey in the same system: UTM zone 10 north.
  for (const auto& p : reading.all.position) {
    ASSERT_NEAR(p.x, 494000, 1500);
    ASSERT_NEAR(p.y, 4877500, 1500);
    ASSERT_NEAR(p.z, 145, 60);
  }
  EXPECT_EQ(reading.all.rgb.size(), 1065u);
  EXPECT_EQ(reading.all.gpsTime.size(), 1065u);
}
