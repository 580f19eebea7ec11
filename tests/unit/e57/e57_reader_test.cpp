// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_reader.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <numeric>

#include <gmock/gmock.h>

#include "unit/e57/e57_builder.h"
#include "unit/ply/scan_reading.h"

namespace fs = std::filesystem;
using namespace alidade;
using alidade::testing::BitWriter;
using alidade::testing::bytesOf;
using alidade::testing::E57Builder;
using alidade::testing::TemporaryFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

const fs::path kData = fs::path(ALIDADE_SHARED_DATA_DIR) / "e57";

struct Outcome {
  std::vector<PointBatch> batches;
  std::string warnings, error;
  std::size_t count() const {
    std::size_t n = 0;
    for (const auto& batch : batches) n += batch.size();
    return n;
  }
  std::vector<glm::dvec3> positions() const {
    std::vector<glm::dvec3> all;
    for (const auto& batch : batches) all.insert(all.end(), batch.position.begin(), batch.position.end());
    return all;
  }
};

Outcome readFile(const std::string& path) {
  Outcome outcome;
  const auto done = E57Reader().read(path, [&](PointBatch& batch) {
    outcome.batches.push_back(std::move(batch));
    return true;
  }, Progress());
  if (!done) outcome.error = done.error().text();
  else for (const auto& warning : *done) outcome.warnings += warning.what + " (" + warning.where + ")\n";
  return outcome;
}

Outcome readBytes(const std::string& bytes) {
  const TemporaryFile file("test.e57", bytes);
  return readFile(file.path());
}

std::string errorOf(const std::string& bytes) {
  const TemporaryFile file("broken.e57", bytes);
  const Outcome outcome = readFile(file.path());
  EXPECT_THAT(outcome.error, HasSubstr("broken.e57"));
  return outcome.error;
}

template <class T>
std::string streamOf(const std::vector<T>& values) {
  std::string bytes;
  for (const T value : values) bytes += bytesOf(value);
  return bytes;
}

std::string floatField(const std::string& name, bool single = false) {
  return "<" + name + " type=\"Float\"" + (single ? " precision=\"single\"" : "") + "/>";
}

std::string integerField(const std::string& name, std::int64_t least, std::int64_t most, const std::string& more = "type=\"Integer\"") {
  return "<" + name + " " + more + " minimum=\"" + std::to_string(least) + "\" maximum=\"" + std::to_string(most) + "\"/>";
}

std::string scanXml(const std::string& head, std::uint64_t offset, std::size_t count, const std::string& fields) {
  return "<vectorChild type=\"Structure\">" + head + "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(offset) +
         "\" recordCount=\"" + std::to_string(count) + "\"><prototype type=\"Structure\">" + fields +
         "</prototype><codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"></codecs></points></vectorChild>";
}

std::string data3D(const std::string& scans) { return "<data3D type=\"Vector\">" + scans + "</data3D>"; }

const std::string kXyz = floatField("cartesianX") + floatField("cartesianY") + floatField("cartesianZ");

/// One plain scan of `count` points (i, 2i, 3i).
std::string plainFile(std::size_t count, std::size_t piece = 8000) {
  std::vector<double> x(count), y(count), z(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = double(i), y[i] = 2 * x[i], z[i] = 3 * x[i];
  E57Builder builder;
  const auto at = builder.addPoints({streamOf(x), streamOf(y), streamOf(z)}, piece);
  return builder.finish(data3D(scanXml("<name type=\"String\">plain</name>", at, count, kXyz)));
}

template <class T>
std::vector<T> extraOf(const PointBatch& batch, const std::string& name, NumberType type) {
  for (const ExtraColumn& column : batch.extra) {
    if (column.name != name) continue;
    EXPECT_EQ(static_cast<int>(column.type), static_cast<int>(type)) << name;
    std::vector<T> values(column.data.size() / sizeof(T));
    std::memcpy(values.data(), column.data.data(), column.data.size());
    return values;
  }
  ADD_FAILURE() << "no extra column " << name;
  return {};
}

}  // namespace

TEST(E57Reader, PointsStandInTheWorldWhereTheirPosesPutThem) {
  // A quarter turn about z: x goes to y, y to -x.
  const double h = std::numbers::sqrt2 / 2;
  E57Builder builder;
  const auto first = builder.addPoints({streamOf<double>({1, 0}), streamOf<double>({0, 1}), streamOf<double>({5, 6})});
  const auto second = builder.addPoints({streamOf<float>({0.1f}), streamOf<float>({0.2f}), streamOf<float>({0.3f})});
  char pose[600];
  std::snprintf(pose, sizeof pose, "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">%.17g</w><x type=\"Float\"/>"
                "<y type=\"Float\"/><z type=\"Float\">%.17g</z></rotation><translation type=\"Structure\"><x type=\"Float\">500000</x>"
                "<y type=\"Float\">6e6</y><z type=\"Float\">100</z></translation></pose>", h, h);
  const TemporaryFile file("poses.e57", builder.finish(data3D(
      scanXml("<name type=\"String\"><![CDATA[Türm 1]]></name>" + std::string(pose) + "<cartesianBounds type=\"Structure\"><xMinimum type=\"Float\"/>"
              "<xMaximum type=\"Float\">1</xMaximum><yMinimum type=\"Float\"/><yMaximum type=\"Float\">1</yMaximum>"
              "<zMinimum type=\"Float\">5</zMinimum><zMaximum type=\"Float\">6</zMaximum></cartesianBounds>", first, 2, kXyz) +
      scanXml("", second, 1, floatField("cartesianX", true) + floatField("cartesianY", true) + floatField("cartesianZ", true)))));
  const Outcome outcome = readFile(file.path());
  ASSERT_EQ(outcome.batches.size(), 2u) << outcome.error;
  const auto& moved = outcome.batches[0];
  EXPECT_NEAR(glm::length(moved.position[0] - glm::dvec3(500000, 6000001, 105)), 0, 1e-9);
  EXPECT_NEAR(glm::length(moved.position[1] - glm::dvec3(499999, 6000000, 106)), 0, 1e-9);
  EXPECT_EQ(outcome.batches[1].position[0], glm::dvec3(0.1f, 0.2f, 0.3f));  // not moved: the file's own floats
  EXPECT_THAT(moved.scanner, ElementsAre(0, 0));
  EXPECT_THAT(outcome.batches[1].scanner, ElementsAre(1));

  const auto info = E57Reader().inspect(file.path());
  ASSERT_TRUE(info);
  ASSERT_EQ(info->stations.size(), 2u);
  EXPECT_EQ(info->stations[0].name, "Türm 1");
  EXPECT_EQ(info->stations[0].worldFromScanner.translation, glm::dvec3(500000, 6e6, 100));
  EXPECT_EQ(info->pointCount, 3u);
  EXPECT_TRUE(info->bounds.empty());  // the second scan does not state its own
}

TEST(E57Reader, EveryFieldFindsItsColumn) {
  // Spherical coordinates, a grid, returns without an echo, colours of 16 bits, raw intensity, a vendor's column.
  BitWriter invalid, rows, columns, returns, counts, red, green, blue, vendor;
  const int invalidOf[] = {0, 1, 2, 0};
  for (int i = 0; i < 4; ++i) {
    invalid.put(static_cast<std::uint64_t>(invalidOf[i]), 2);
    rows.put(static_cast<std::uint64_t>(i / 2), 4);
    columns.put(static_cast<std::uint64_t>(i % 2), 4);
    returns.put(static_cast<std::uint64_t>(i == 3), 1);
    counts.put(2, 2);
    red.put(static_cast<std::uint64_t>(1000 * i), 10 + 6);
    green.put(65535, 16);
    blue.put(static_cast<std::uint64_t>(i), 16);
    vendor.put(static_cast<std::uint64_t>(i), 5);
  }
  E57Builder builder;
  const double q = std::numbers::pi / 2;
  const auto at = builder.addPoints({streamOf<double>({2, 1, 1, 4}), streamOf<double>({0, 0, 0, q}), streamOf<double>({0, 0, 0, q / 3}),
                                     invalid.bytes(), rows.bytes(), columns.bytes(), returns.bytes(), counts.bytes(), red.bytes(),
                                     green.bytes(), blue.bytes(), streamOf<float>({-10, 0, 0, 30}), streamOf<double>({1.5, 2, 3, 4.5}),
                                     streamOf<float>({0, 0, 0, 1}), streamOf<float>({2, 0, 0, 0}), streamOf<float>({0, 0, 0, 0}), vendor.bytes()}, 3);
  const std::string limits =
      "<intensityLimits type=\"Structure\"><intensityMinimum type=\"Float\">-10</intensityMinimum><intensityMaximum type=\"Float\">30</intensityMaximum></intensityLimits>"
      "<indexBounds type=\"Structure\"><rowMinimum type=\"Integer\">7</rowMinimum><rowMaximum type=\"Integer\">8</rowMaximum>"
      "<columnMinimum type=\"Integer\"/><columnMaximum type=\"Integer\">1</columnMaximum></indexBounds>";
  const std::string fields = floatField("sphericalRange") + floatField("sphericalAzimuth") + floatField("sphericalElevation") +
                             integerField("sphericalInvalidState", 0, 2) + integerField("rowIndex", 7, 22) + integerField("columnIndex", 0, 15) +
                             integerField("returnIndex", 0, 1) + integerField("returnCount", 0, 3) + integerField("colorRed", 0, 65535) +
                             integerField("colorGreen", 0, 65535) + integerField("colorBlue", 0, 65535) + floatField("intensity", true) +
                             floatField("timeStamp") + floatField("nor:normalX", true) + floatField("nor:normalY", true) +
                             floatField("nor:normalZ", true) + integerField("acme:quality", -20, 11);
  const TemporaryFile file("fields.e57", builder.finish(data3D(scanXml(limits, at, 4, fields))));
  const Outcome outcome = readFile(file.path());
  ASSERT_EQ(outcome.count(), 2u) << outcome.error;
  ASSERT_EQ(outcome.batches.size(), 1u);
  const PointBatch& batch = outcome.batches[0];
  EXPECT_NEAR(glm::length(batch.position[0] - glm::dvec3(2, 0, 0)), 0, 1e-12);
  EXPECT_NEAR(glm::length(batch.position[1] - glm::dvec3(0, 4 * std::cos(q / 3), 2)), 0, 1e-12);
  EXPECT_THAT(batch.row, ElementsAre(0, 1));
  EXPECT_THAT(batch.column, ElementsAre(0, 1));
  EXPECT_THAT(batch.returnNumber, ElementsAre(1, 2));
  EXPECT_THAT(batch.returnCount, ElementsAre(2, 2));
  EXPECT_EQ(batch.rgbWhite, 65535);
  EXPECT_THAT(batch.rgb, ElementsAre(glm::u16vec3(0, 65535, 0), glm::u16vec3(3000, 65535, 3)));
  EXPECT_THAT(batch.intensity, ElementsAre(0, 65535));
  EXPECT_THAT(batch.gpsTime, ElementsAre(1.5, 4.5));
  EXPECT_THAT(batch.normal, ElementsAre(glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)));
  EXPECT_THAT(extraOf<float>(batch, "intensity", NumberType::F32), ElementsAre(-10.f, 30.f));
  EXPECT_THAT(extraOf<std::int8_t>(batch, "acme:quality", NumberType::I8), ElementsAre(-20, -17));
  EXPECT_THAT(outcome.warnings, HasSubstr("2 directions without a return"));
  const auto info = E57Reader().inspect(file.path());
  ASSERT_TRUE(info);
  EXPECT_EQ(info->stations[0].rows, 2u);
  EXPECT_EQ(info->stations[0].columns, 2u);
  EXPECT_THAT(info->attributes, ::testing::Contains("acme:quality"));
}

TEST(E57Reader, RecordsRunOnOverPacketsOfAnySize) {
  const std::string whole = plainFile(1000);
  const auto truth = readBytes(whole).positions();
  ASSERT_EQ(truth.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(truth[i], glm::dvec3(double(i), 2.0 * double(i), 3.0 * double(i)));
  for (const std::size_t piece : {5, 7, 100, 1019}) EXPECT_EQ(readBytes(plainFile(1000, piece)).positions(), truth) << piece;
}

TEST(E57Reader, ScaledIntegersKeepTheirStepAndTheFirstPrototypeNeedNotBeThePoints) {
  BitWriter x, y, z;
  for (const int raw : {0, 5, 1000}) x.put(static_cast<std::uint64_t>(raw), 10), y.put(0, 10), z.put(static_cast<std::uint64_t>(1000 - raw), 10);
  E57Builder builder;
  const auto at = builder.addPoints({x.bytes(), y.bytes(), z.bytes()});
  const std::string scaled = "type=\"ScaledInteger\" scale=\"0.001\" offset=\"100\"";
  const std::string groups = "<pointGroupingSchemes type=\"Structure\"><groups type=\"CompressedVector\" fileOffset=\"9999\" recordCount=\"77\">"
                             "<prototype type=\"Structure\"><startPointIndex type=\"Integer\"/></prototype></groups></pointGroupingSchemes>";
  const TemporaryFile file("scaled.e57", builder.finish(data3D(scanXml(groups, at, 3,
      integerField("cartesianX", -500, 500, scaled) + integerField("cartesianY", -500, 500, scaled) + integerField("cartesianZ", -500, 500, scaled)))));
  const auto info = E57Reader().inspect(file.path());
  ASSERT_TRUE(info) << info.error().text();
  EXPECT_EQ(info->scale, glm::dvec3(0.001));
  EXPECT_EQ(info->offset, glm::dvec3(100));
  const auto points = readFile(file.path()).positions();
  ASSERT_EQ(points.size(), 3u);
  const int raw[] = {-500, -495, 500};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(points[i], glm::dvec3(raw[i] * 0.001 + 100, -500 * 0.001 + 100, -raw[i] * 0.001 + 100));
}

TEST(E57Reader, TextColumnsArePassedOverAndConstantsTakeNoBits) {
  E57Builder builder;
  const std::string names = std::string("\x0a") + "hello" + "\x02x";  // 5 and 1 letters, each behind length * 2
  const auto at = builder.addPoints({names, streamOf<double>({1, 2}), "", streamOf<double>({3, 4})});
  const Outcome outcome = readBytes(builder.finish(data3D(scanXml("", at, 2,
      "<acme:label type=\"String\"/>" + floatField("cartesianX") + integerField("cartesianY", 9, 9) + floatField("cartesianZ")))));
  EXPECT_THAT(outcome.positions(), ElementsAre(glm::dvec3(1, 9, 3), glm::dvec3(2, 9, 4))) << outcome.error;
  EXPECT_THAT(outcome.warnings, HasSubstr("acme:label"));
}

TEST(E57Reader, SamplesEvenlyWithoutReadingAll) {
  const TemporaryFile file("sample.e57", plainFile(200000, 1003));
  std::vector<double> x;
  const auto done = E57Reader().sample(file.path(), 2000, [&](PointBatch& batch) {
    for (const auto& p : batch.position) {
      EXPECT_EQ(p, glm::dvec3(p.x, 2 * p.x, 3 * p.x));
      x.push_back(p.x);
    }
    return true;
  }, Progress());
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_GT(x.size(), 1000u);
  EXPECT_LT(x.size(), 4000u);
  std::vector<int> tenths(10);
  for (const double each : x) ++tenths[static_cast<std::size_t>(each / 20000)];
  for (const int count : tenths) EXPECT_NEAR(count, double(x.size()) / 10, double(x.size()) / 40);
}

TEST(E57Reader, BrokenFilesAreRefusedWithTheirReason) {
  EXPECT_THAT(errorOf("hello"), HasSubstr("no E57 file"));
  EXPECT_THAT(errorOf("ASTM-E57"), HasSubstr("less than one page"));
  const std::string good = plainFile(100);
  const auto changed = [&](std::size_t at, const std::string& bytes) {  // with its checksums mended
    std::string content;
    for (std::size_t page = 0; page < good.size(); page += 1024) content += good.substr(page, 1020);
    content.replace(at, bytes.size(), bytes);
    return E57Builder::paged(content);
  };
  EXPECT_THAT(errorOf(good.substr(0, 2048)), HasSubstr("cut off"));
  std::string flipped = good;
  flipped[1500] = static_cast<char>(flipped[1500] ^ 1);
  EXPECT_THAT(errorOf(flipped), HasSubstr("checksum of page 1"));
  EXPECT_THAT(errorOf(changed(8, "\2")), HasSubstr("version 2.0"));
  EXPECT_THAT(errorOf(changed(40, std::string("\0\x08", 2))), HasSubstr("2048 bytes"));
  EXPECT_THAT(errorOf(changed(24, "\xff\xff\xff")), HasSubstr("XML section points"));
  EXPECT_THAT(errorOf(changed(32, "\xff\xff\xff")), HasSubstr("promises"));
  EXPECT_THAT(errorOf(changed(48, "\xb6")), HasSubstr("begins with 182"));
  EXPECT_THAT(errorOf(changed(56, "\xff\xff\xff")), HasSubstr("says that it has"));
  EXPECT_THAT(errorOf(changed(64, "\1")), HasSubstr("outside the point section"));
  EXPECT_THAT(errorOf(changed(80, "\7")), HasSubstr("unknown type 7"));
  EXPECT_THAT(errorOf(changed(82, "\xff\xff")), HasSubstr("reaches beyond"));
  EXPECT_THAT(errorOf(changed(84, "\2")), HasSubstr("2 streams for 3 fields"));
  EXPECT_THAT(errorOf(changed(86, "\xff\xff")), HasSubstr("streams take"));
  EXPECT_THAT(errorOf(changed(86, "\x08")), HasSubstr("ends after"));
}

TEST(E57Reader, BrokenDescriptionsAreRefusedWithTheirReason) {
  const auto file = [](const std::string& head, std::size_t count, const std::string& fields, int section = 1) {
    E57Builder builder;
    const std::string eight(8, '\0');
    return builder.finish(data3D(scanXml(head, builder.addPoints({eight, eight, eight}, 8000, section), count, fields)));
  };
  EXPECT_THAT(errorOf(file("", 1000000, kXyz)), HasSubstr("promises 1000000 points"));
  EXPECT_THAT(errorOf(file("", 1, floatField("a") + floatField("b") + floatField("c"))), HasSubstr("neither cartesian nor spherical"));
  EXPECT_THAT(errorOf(file("", 1, "<cartesianX type=\"Quaternion\"/>")), HasSubstr("unknown type 'Quaternion'"));
  EXPECT_THAT(errorOf(file("", 1, integerField("cartesianX", 5, 4))), HasSubstr("above its maximum"));
  EXPECT_THAT(errorOf(file("", 1, integerField("cartesianX", 0, 4, "type=\"ScaledInteger\" scale=\"0\""))), HasSubstr("scale of 0"));
  EXPECT_THAT(errorOf(file("<pose type=\"Structure\"><translation><x type=\"Float\">nan</x></translation></pose>", 1, kXyz)), HasSubstr("no number"));
  EXPECT_THAT(errorOf(E57Builder().finish("<data3D><a>")), HasSubstr("XML section is broken"));
  EXPECT_THAT(errorOf(E57Builder().finish("<data3D><vectorChild/></data3D>")), HasSubstr("no points"));
  // Two scans that say that they share a section.
  E57Builder builder;
  const auto at = builder.addPoints({std::string(8000, '\0'), std::string(8000, '\0'), std::string(8000, '\0')});
  EXPECT_THAT(errorOf(builder.finish(data3D(scanXml("", at, 1000, kXyz) + scanXml("", at, 1000, kXyz)))), HasSubstr("overlap"));
  // A document type that blows up where entities are expanded, and elements nested without end.
  const std::string bomb = "<!DOCTYPE a [<!ENTITY b \"bbbbbbbb\"><!ENTITY c \"&b;&b;&b;\">]>";
  EXPECT_EQ(readBytes(E57Builder().finish(bomb + data3D(""))).count(), 0u);
  std::string deep, up;
  for (int i = 0; i < 50000; ++i) deep += "<a type=\"Structure\">", up += "</a>";
  EXPECT_THAT(errorOf(file("", 1, deep + up)), HasSubstr("nested too deeply"));
}

TEST(E57Reader, NoCutAndNoFlippedBitCrashes) {
  const std::string good = plainFile(300, 100);
  for (std::size_t length = 0; length < good.size(); length += 97) readBytes(good.substr(0, length));
  std::string content;
  for (std::size_t page = 0; page < good.size(); page += 1024) content += good.substr(page, 1020);
  for (std::size_t bit = 0; bit < content.size() * 8; bit += 61) {
    std::string broken = content;
    broken[bit / 8] = static_cast<char>(broken[bit / 8] ^ 1 << bit % 8);
    EXPECT_LE(readBytes(E57Builder::paged(broken)).count(), 4000u) << bit;
  }
}

TEST(E57Reader, SiblingFilesOfSharedDataHoldTheSamePoints) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const auto real = readFile((kData / "reference/bunnyDouble.e57").string()).positions();
  const auto whole = readFile((kData / "reference/bunnyInt32.e57").string()).positions();
  ASSERT_EQ(real.size(), 30571u);
  ASSERT_EQ(whole.size(), 30571u);
  glm::dvec3 sum(0);
  for (std::size_t i = 0; i < real.size(); ++i) {
    ASSERT_NEAR(glm::length(real[i] - whole[i]), 0, 1e-9) << i;
    sum += real[i];
  }
  // Summed by a decoder of the packets written in another language on arbitrary-precision integers.
  EXPECT_NEAR(sum.x, -841.0932979999978, 1e-9);
  EXPECT_NEAR(sum.y, 3151.1987419999805, 1e-9);
  EXPECT_NEAR(sum.z, 264.2439720000011, 1e-9);
  EXPECT_EQ(real.back(), glm::dvec3(-0.037829, 0.12794, 0.004474));  // the first line of bunny_8.pts

  const auto single = readFile((kData / "self/ColouredCubeFloat.e57").string());
  const auto twice = readFile((kData / "self/ColouredCubeDouble.e57").string());
  ASSERT_EQ(single.count(), 7680u) << single.error;
  EXPECT_EQ(single.positions(), twice.positions());
  EXPECT_EQ(single.batches[0].rgb, twice.batches[0].rgb);
  // libE57Format's test paints the faces across x blue, across y green, across z red.
  std::map<int, int> faces;
  for (std::size_t i = 0; i < 7680; ++i) {
    const glm::dvec3 p = glm::abs(single.batches[0].position[i]);
    const int axis = p.x == 0.5 ? 0 : p.y == 0.5 ? 1 : 2;
    glm::u16vec3 colour(0);
    colour[2 - axis] = 255;
    EXPECT_EQ(p[axis], 0.5) << i;
    EXPECT_EQ(single.batches[0].rgb[i], colour) << i;
    ++faces[axis];
  }
  for (const auto& [axis, count] : faces) EXPECT_EQ(count, 2560);
}

TEST(E57Reader, SharedFilesOfSeveralScansAndSixteenBitColours) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const Outcome dims = readFile((kData / "e57/A_B_different_dims.e57").string());
  ASSERT_EQ(dims.batches.size(), 2u) << dims.error;
  EXPECT_EQ(dims.batches[0].position[0], glm::dvec3(84.17402648925781, 537.2703247070312, 4.628726005554199));
  EXPECT_TRUE(dims.batches[0].rgb.empty());
  EXPECT_THAT(extraOf<float>(dims.batches[0], "intensity", NumberType::F32), ElementsAre(0.7596482634544373f));
  EXPECT_THAT(dims.batches[1].rgb, ElementsAre(glm::u16vec3(74, 92, 54)));
  EXPECT_TRUE(dims.batches[1].intensity.empty());
  // A and B apart, and the file that merges them.
  const auto apart = readFile((kData / "e57/A_B.e57").string()).positions();
  EXPECT_EQ(apart.size(), 6u);
  EXPECT_EQ(apart, readFile((kData / "e57/A_merged_B.e57").string()).positions());

  const Outcome las = readFile((kData / "3rdParty/las2e57/ColourRepresentation.e57").string());
  ASSERT_EQ(las.count(), 153u) << las.error;
  EXPECT_EQ(las.batches[0].rgbWhite, 65535);
  std::uint64_t red = 0;
  for (const auto& c : las.batches[0].rgb) red += c.r;
  EXPECT_EQ(red, 3264000u);  // by the same independent decoder
  EXPECT_THAT(las.batches[0].returnNumber, ::testing::Each(1));
  EXPECT_THAT(las.batches[0].pointSource, ::testing::Each(1));
}

TEST(E57Reader, OddSharedFilesGiveTheirErrorOrNoPoints) {
  if (!fs::exists(kData)) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  const auto self = [](const char* name) { return readFile((kData / "self" / name).string()); };
  EXPECT_THAT(self("bad-crc.e57").error, HasSubstr("checksum of page 0"));
  EXPECT_THAT(self("InvalidCVHeader.e57").error, HasSubstr("no point section"));
  for (const char* name : {"empty.e57", "ZeroPoints.e57", "ZeroPointsInvalid.e57", "test filename äöü.e57", "测试点云.e57",
                           "PinholeImageWithDistortionParameters.e57"}) {
    EXPECT_EQ(self(name).error, "") << name;
    EXPECT_EQ(self(name).count(), 0u) << name;
  }
  EXPECT_THAT(self("ZeroPointsInvalid.e57").warnings, HasSubstr("no points"));
}
