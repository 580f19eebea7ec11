// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ply/ply_reader.h"

#include <gmock/gmock.h>

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

const fs::path kData = fs::path(ALIDADE_SHARED_DATA_DIR) / "text_and_ply/ply";

ScanReading readText(const std::string& content) {
  const TemporaryFile file("test.ply", content);
  return readScan(PlyReader(), file.path());
}

std::string errorOf(const std::string& content) {
  const TemporaryFile file("broken.ply", content);
  const ScanReading reading = readScan(PlyReader(), file.path());
  EXPECT_THAT(reading.error, HasSubstr(file.path()));
  EXPECT_TRUE(reading.all.position.empty());
  return reading.error;
}

const std::string kHead = "ply\nformat ascii 1.0\n";
const std::string kXyz = "property double x\nproperty double y\nproperty double z\n";
const std::string kEnd = "end_header\n";

}  // namespace

TEST(PlyReader, TextKeepsEveryDigitThatADoubleHolds) {
  const auto reading = readText(kHead + "element vertex 2\n" + kXyz + kEnd +
                                "2683500.1234567 1247800.7654321 -0.25\n+1e3 2 3\n");
  ASSERT_EQ(reading.all.size(), 2u) << reading.error;
  EXPECT_EQ(reading.all.position[0], glm::dvec3(2683500.1234567, 1247800.7654321, -0.25));
  EXPECT_EQ(reading.all.position[1].x, 1000.0);
}

TEST(PlyReader, BothByteOrdersGiveTheSamePointsBehindElementsThatAreSkipped) {
  for (const bool big : {false, true}) {
    std::string content = std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") +
                          " 1.0\nelement camera 2\nproperty float f\nelement face 2\n"
                          "property list uchar int vertex_indices\nelement vertex 2\nproperty uchar red\n" +
                          kXyz + "property uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\n"
                                 "property float nz\n" + kEnd;
    content += bytesOf(1.0f, big) + bytesOf(2.0f, big);
    for (const int corners : {3, 4}) {
      content += bytesOf(static_cast<std::uint8_t>(corners));
      for (int i = 0; i < corners; ++i) content += bytesOf(i, big);
    }
    for (const double x : {1.5, 100551.867}) {
      content += bytesOf(std::uint8_t{200}) + bytesOf(x, big) + bytesOf(2.0, big) + bytesOf(3.0, big);
      content += bytesOf(std::uint8_t{100}) + bytesOf(std::uint8_t{50});
      content += bytesOf(0.0f, big) + bytesOf(3.0f, big) + bytesOf(4.0f, big);
    }
    const auto reading = readText(content);
    ASSERT_EQ(reading.all.size(), 2u) << reading.error;
    EXPECT_EQ(reading.all.position[1], glm::dvec3(100551.867, 2, 3));
    EXPECT_EQ(reading.all.rgb[0], glm::u16vec3(200, 100, 50));
    EXPECT_NEAR(reading.all.normal[0].z, 0.8, 1e-6);
    EXPECT_THAT(reading.warnings, HasSubstr("2 faces were ignored"));
  }
}

TEST(PlyReader, AListAmongTheVertexPropertiesIsPassedOver) {
  std::string content = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\n"
                        "property list uint8 double junk\nproperty float y\nproperty float z\n" + kEnd;
  for (int i = 0; i < 2; ++i) {
    content += bytesOf(1.0f + i) + bytesOf(static_cast<std::uint8_t>(i));
    for (int j = 0; j < i; ++j) content += bytesOf(9.0);
    content += bytesOf(2.0f) + bytesOf(3.0f);
  }
  const auto reading = readText(content);
  ASSERT_EQ(reading.all.size(), 2u) << reading.error;
  EXPECT_EQ(reading.all.position[1], glm::dvec3(2, 2, 3));
  const auto text = readText(kHead + "element vertex 1\nproperty float x\nproperty list uchar int junk\n"
                                     "property float y\nproperty float z\n" + kEnd + "1 3 7 8 9 2 3\n");
  EXPECT_THAT(text.all.position, ElementsAre(glm::dvec3(1, 2, 3))) << text.error;
}

TEST(PlyReader, ColoursAndIntensitiesOfAnyRangeBecomeFullRange) {
  const auto floats = readText(kHead + "element vertex 1\n" + kXyz +
                               "property float r\nproperty float g\nproperty float b\nproperty float scalar_Intensity\n" +
                               kEnd + "1 2 3 1 0.5 0 0.25\n");
  EXPECT_THAT(floats.all.rgb, ElementsAre(glm::u16vec3(255, 127, 0))) << floats.error;
  EXPECT_NEAR(floats.all.intensity[0], 16384, 1);
  const auto shorts = readText(kHead + "element vertex 1\n" + kXyz +
                               "property ushort diffuse_red\nproperty ushort diffuse_green\n"
                               "property ushort diffuse_blue\nproperty uchar intensity\n" + kEnd + "1 2 3 65535 32768 256 255\n");
  EXPECT_THAT(shorts.all.rgb, ElementsAre(glm::u16vec3(255, 128, 1))) << shorts.error;
  EXPECT_EQ(shorts.all.intensity[0], 65535);
}

TEST(PlyReader, PointsWithoutUsableCoordinatesAreLeftOutAndCounted) {
  const auto reading = readText(kHead + "element vertex 5\n" + kXyz + kEnd +
                                "nan 0 0\n1 2 3\ninf 1 1\n1e300 0 0\n0 1e999 0\n");
  EXPECT_THAT(reading.all.position, ElementsAre(glm::dvec3(1, 2, 3))) << reading.error;
  EXPECT_THAT(reading.warnings, HasSubstr("4 points"));
}

TEST(PlyReader, MoreThanOneBatchArrivesInOrder) {
  std::string content = kHead + "element vertex 150000\r\n" + kXyz + "end_header\r\n";
  for (int i = 0; i < 150000; ++i) content += std::to_string(i) + " 0 0\r\n";
  const auto reading = readText(content);
  ASSERT_EQ(reading.all.size(), 150000u) << reading.error;
  for (int i = 0; i < 150000; ++i) ASSERT_EQ(reading.all.position[i].x, i);
}

TEST(PlyReader, BrokenFilesAreRefusedWithTheirReason) {
  const std::string vertex = "element vertex 2\n" + kXyz;
  EXPECT_THAT(errorOf(""), HasSubstr("header has no end"));
  EXPECT_THAT(errorOf("LASF"), HasSubstr("no PLY file"));
  EXPECT_THAT(errorOf(kHead + vertex), HasSubstr("no end"));
  EXPECT_THAT(errorOf("ply\n" + vertex + kEnd), HasSubstr("does not say its format"));
  EXPECT_THAT(errorOf("ply\nformat morse 1.0\n" + vertex + kEnd), HasSubstr("format morse"));
  EXPECT_THAT(errorOf(kHead + "element vertex -2\n" + kEnd), HasSubstr("vertex -2"));
  EXPECT_THAT(errorOf(kHead + "property float x\n" + kEnd), HasSubstr("property float x"));
  EXPECT_THAT(errorOf(kHead + "element vertex 1\nproperty quad x\n" + kEnd), HasSubstr("quad"));
  EXPECT_THAT(errorOf(kHead + "element vertex 1\nproperty float x\nproperty float y\n" + kEnd + "1 2\n"),
              HasSubstr("no x, y and z"));
  EXPECT_THAT(errorOf(kHead + kEnd), HasSubstr("no element \"vertex\""));
  EXPECT_THAT(errorOf(kHead + vertex + kEnd + "1.0 2.0 3.0\n1 2\n"), HasSubstr("has 2 of 3 values"));
  EXPECT_THAT(errorOf(kHead + vertex + kEnd + "1 2 3\n1 two 3\n"), HasSubstr("\"two\""));
  EXPECT_THAT(errorOf(kHead + vertex + kEnd + "11111 22222 33333\n"), HasSubstr("ends after 1"));
  EXPECT_THAT(errorOf(kHead + "element vertex 18446744073709551615\n" + kXyz + kEnd + "1 2 3\n"),
              HasSubstr("promises 18446744073709551615"));
  EXPECT_THAT(errorOf("ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + kXyz + kEnd + std::string(71, 'x')),
              HasSubstr("room for 2"));
  EXPECT_THAT(errorOf("ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint int v\n" + vertex + kEnd +
                      "\xff\xff\xff\xff" + std::string(100, 'x')),
              HasSubstr("4294967295 entries"));
  EXPECT_THAT(errorOf(kHead + std::string(100000, 'a')), HasSubstr("longer"));
}

TEST(PlyReader, InspectCountsWithoutReadingAndNamesTheColumns) {
  const TemporaryFile file("inspect.ply", "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 1\n" + kXyz +
                                              "property uchar red\nproperty uchar green\nproperty uchar blue\n" + kEnd +
                                              "1 2 3 4 5 6\n");
  const auto info = PlyReader().inspect(file.path());
  ASSERT_TRUE(info.has_value());
  EXPECT_EQ(info->pointCount, 1u);
  EXPECT_THAT(info->attributes, ElementsAre("rgb"));
  EXPECT_EQ(info->details, "PLY, ascii, made by hand");
}

TEST(PlyReader, FilesWithFacesAreLeftToAMeshReaderThatClaimsMore) {
  const auto sniff = [](std::string_view head) {
    FileProbe probe;
    probe.extension = "ply";
    probe.head = std::as_bytes(std::span(head));
    return PlyReader().sniff(probe);
  };
  EXPECT_EQ(sniff("ply\nelement vertex 3\n"), 100);
  EXPECT_EQ(sniff("ply\nelement vertex 3\nelement face 2\n"), 60);
  EXPECT_EQ(sniff("ply\nelement vertex 3\nelement face 0\n"), 100);
  EXPECT_EQ(sniff("hello"), 20);
}

TEST(PlyReader, RealFilesOfOtherProgramsAreReadOrRefused) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const auto count = [](const char* name) { return readScan(PlyReader(), (kData / name).string()).all.size(); };
  EXPECT_EQ(count("simple_text.ply"), 3u);
  EXPECT_EQ(count("simple_binary.ply"), 3u);
  EXPECT_EQ(count("mesh.ply"), 4u);
  EXPECT_EQ(count("issue_2421.ply"), 1u);
  const auto extra = readScan(PlyReader(), (kData / "text_extradim.ply").string());
  ASSERT_EQ(extra.all.size(), 1u) << extra.error;
  EXPECT_EQ(extra.all.rgb[0], glm::u16vec3(63, 200, 64));
  EXPECT_EQ(extra.all.position[0], glm::dvec3(-2.64944, -13.0955, 0.00640115));
  const auto binary = readScan(PlyReader(), (kData / "simple_binary.ply").string());
  EXPECT_THAT(binary.all.position, ElementsAre(glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0)));
  for (const char* name : {"no_vertex.ply", "sized_dims.ply", "unsized_dims.ply"})
    EXPECT_THAT(readScan(PlyReader(), (kData / name).string()).error, HasSubstr("no "));
  const auto road = readScan(PlyReader(), (kData.parent_path().parent_path() / "road/road.ply").string());
  EXPECT_EQ(road.all.size(), 26002u);
  EXPECT_THAT(road.warnings, HasSubstr("49999 faces"));
}
