// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_reader.h"

#include <limits>

#include <gmock/gmock.h>

#include "unit/las/las_file_maker.h"

using alidade::ImportWarning;
using alidade::LasReader;
using alidade::PointBatch;
using alidade::Progress;
using alidade::testing::LasFileMaker;
using ::testing::Contains;
using ::testing::HasSubstr;

namespace {

struct Reading {
  PointBatch all;
  std::vector<ImportWarning> warnings;
  std::string error;
};

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

Reading readAll(const std::string& path) {
  Reading reading;
  const auto outcome = LasReader().read(
      path,
      [&](const PointBatch& batch) {
        append(reading.all.position, batch.position);
        append(reading.all.rgb, batch.rgb);
        reading.all.rgbWhite = batch.rgbWhite;
        append(reading.all.intensity, batch.intensity);
        append(reading.all.classification, batch.classification);
        append(reading.all.returnNumber, batch.returnNumber);
        append(reading.all.returnCount, batch.returnCount);
        append(reading.all.gpsTime, batch.gpsTime);
        append(reading.all.pointSource, batch.pointSource);
        append(reading.all.scanner, batch.scanner);
        append(reading.all.row, batch.row);
        append(reading.all.column, batch.column);
        return true;
      },
      Progress());
  if (outcome)
    reading.warnings = *outcome;
  else
    reading.error = outcome.error().text();
  return reading;
}

std::string warningsOf(const Reading& reading) {
  std::string text;
  for (const auto& warning : reading.warnings) text += warning.what + "\n";
  return text;
}

std::string errorOf(const LasFileMaker& file, const std::string& name = "broken.las") {
  const std::string path = file.write(name);
  const Reading reading = readAll(path);
  const auto inspected = LasReader().inspect(path);
  EXPECT_FALSE(inspected.has_value()) << "inspect took what read refuses";
  EXPECT_EQ(reading.all.size(), 0u) << "points were handed over before the error";
  EXPECT_THAT(reading.error, HasSubstr(path));
  std::filesystem::remove(path);
  return reading.error;
}

LasFileMaker twoPoints(int minor = 2, int format = 3, std::uint16_t length = 34) {
  LasFileMaker file(minor, format, length);
  file.addPoint(1, 2, 3);
  file.addPoint(-4, 5, 6);
  return file;
}

}  // namespace

TEST(LasReader, CoordinatesAreScaleTimesIntegerPlusOffsetToTheLastBit) {
  LasFileMaker file(2, 0, 20);
  const glm::dvec3 scale(0.0001, 0.001, 0.01), offset(2683500.123, 1247800.456, 412.789);
  for (int axis = 0; axis < 3; ++axis) {
    file.put<double>(131 + 8 * axis, scale[axis]);
    file.put<double>(155 + 8 * axis, offset[axis]);
  }
  file.addPoint(2147483647, -2147483647 - 1, 123456789);
  const Reading reading = readAll(file.write("exact.las"));
  ASSERT_EQ(reading.all.size(), 1u) << reading.error;
  EXPECT_EQ(reading.all.position[0].x, 0.0001 * 2147483647.0 + 2683500.123);
  EXPECT_EQ(reading.all.position[0].y, 0.001 * -2147483648.0 + 1247800.456);
  EXPECT_EQ(reading.all.position[0].z, 0.01 * 123456789.0 + 412.789);
}

TEST(LasReader, EveryFieldComesFromItsPlaceInEachFormat) {
  struct Layout {
    int minor, format;
    std::uint16_t length;
    int gps, rgb, source, classOffset;
  };
  // LAS 1.4 R15, tables 7-17: byte offsets by hand, -1 where the format lacks the field.
  for (const Layout& l : {Layout{0, 0, 20, -1, -1, 18, 15}, Layout{0, 1, 28, 20, -1, 18, 15},
                          Layout{2, 2, 26, -1, 20, 18, 15}, Layout{2, 3, 34, 20, 28, 18, 15},
                          Layout{4, 6, 30, 22, -1, 20, 16}, Layout{4, 7, 36, 22, 30, 20, 16},
                          Layout{4, 8, 38, 22, 30, 20, 16}}) {
    LasFileMaker file(l.minor, l.format, l.length);
    const std::size_t at = file.addPoint(1, 2, 3);
    file.put<std::uint16_t>(at + 12, 54321);
    file.put<std::uint8_t>(at + 14, l.format >= 6 ? 0xFC : 0xFD);  // 12 of 15; 5 of 7
    file.put<std::uint8_t>(at + l.classOffset, l.format >= 6 ? 66 : 0xE6);
    file.put<std::uint16_t>(at + l.source, 7326);
    if (l.gps > 0) file.put<double>(at + l.gps, 245380.78254962614);
    if (l.rgb > 0)
      for (int c = 0; c < 3; ++c) file.put<std::uint16_t>(at + l.rgb + 2 * c, static_cast<std::uint16_t>(0x1234 + 0x4000 * c));
    const Reading reading = readAll(file.write("format.las"));
    ASSERT_EQ(reading.all.size(), 1u) << "format " << l.format << ": " << reading.error;
    EXPECT_EQ(reading.all.intensity[0], 54321);
    EXPECT_EQ(reading.all.returnNumber[0], l.format >= 6 ? 12 : 5);
    EXPECT_EQ(reading.all.returnCount[0], l.format >= 6 ? 15 : 7);
    EXPECT_EQ(reading.all.classification[0], l.format >= 6 ? 66 : 6);
    EXPECT_EQ(reading.all.pointSource[0], 7326);
    ASSERT_EQ(reading.all.gpsTime.size(), l.gps > 0 ? 1u : 0u);
    if (l.gps > 0) {
      EXPECT_EQ(reading.all.gpsTime[0], 245380.78254962614);
    }
    ASSERT_EQ(reading.all.rgb.size(), l.rgb > 0 ? 1u : 0u);
    if (l.rgb > 0) {
      EXPECT_EQ(reading.all.rgb[0], glm::u16vec3(0x1234, 0x5234, 0x9234));
      EXPECT_EQ(reading.all.rgbWhite, 65535);
    }
  }
}

TEST(LasReader, ColoursStoredAsEightBitsAreNotShiftedAwayAndOneBrightPointDecidesOtherwise) {
  LasFileMaker file(2, 2, 26);
  std::size_t last = 0;
  for (int i = 0; i < 200000; ++i) {
    last = file.addPoint(i, i, i);
    file.put<std::uint16_t>(last + 20, 200);
  }
  Reading reading = readAll(file.write("dim.las"));
  ASSERT_EQ(reading.all.rgb.size(), 200000u);
  EXPECT_EQ(reading.all.rgb[7].r, 200);
  EXPECT_EQ(reading.all.rgbWhite, 255);
  EXPECT_EQ(reading.all.rgb8(7).r, 200);
  EXPECT_THAT(warningsOf(reading), HasSubstr("8-bit"));

  file.put<std::uint16_t>(last + 22, 65280);
  reading = readAll(file.write("dim.las"));
  EXPECT_EQ(reading.all.rgbWhite, 65535);
  EXPECT_EQ(reading.all.rgb[7].r, 200);
  EXPECT_EQ(reading.all.rgb8(7).r, 0);
  EXPECT_EQ(reading.all.rgb8(199999).g, 255);
}

TEST(LasReader, ExtraBytesNamedRowColumnAndScannerFillThoseColumns) {
  LasFileMaker file(4, 7, 36 + 2 + 4 + 4 + 1);
  std::vector<std::uint8_t> entries;
  append(entries, LasFileMaker::extraBytes("Scanner", 3));
  append(entries, LasFileMaker::extraBytes("row", 5));
  append(entries, LasFileMaker::extraBytes("column", 6));
  append(entries, LasFileMaker::extraBytes("reflectance", 1));
  file.addVlr("LASF_Spec", 4, entries);
  const std::size_t at = file.addPoint(1, 2, 3);
  file.put<std::uint16_t>(at + 20, 99);
  file.put<std::uint16_t>(at + 36, 2);
  file.put<std::uint32_t>(at + 38, 1234567);
  file.put<std::int32_t>(at + 42, 89);
  const std::string path = file.write("extra.las");
  const Reading reading = readAll(path);
  ASSERT_EQ(reading.all.size(), 1u) << reading.error;
  EXPECT_THAT(reading.all.scanner, ::testing::ElementsAre(2));
  EXPECT_THAT(reading.all.pointSource, ::testing::ElementsAre(99));
  EXPECT_THAT(reading.all.row, ::testing::ElementsAre(1234567u));
  EXPECT_THAT(reading.all.column, ::testing::ElementsAre(89u));
  EXPECT_THAT(LasReader().inspect(path)->attributes, Contains("reflectance"));
  // Columns of other types than the record's: its records alone would not tell them.
  const auto never = [](std::uint64_t, const alidade::PointRecords&) { return ADD_FAILURE(), false; };
  const auto records = LasReader().readRecords(path, never, Progress());
  ASSERT_TRUE(records.has_value());
  EXPECT_FALSE(records->has_value());
}

TEST(LasReader, ExtraBytesThatReachPastTheRecordAreIgnoredWithAWarning) {
  LasFileMaker file(4, 6, 31);
  file.addVlr("LASF_Spec", 4, LasFileMaker::extraBytes("row", 7));
  file.addPoint(1, 2, 3);
  const Reading reading = readAll(file.write("extra_long.las"));
  EXPECT_EQ(reading.all.size(), 1u);
  EXPECT_TRUE(reading.all.row.empty());
  EXPECT_THAT(warningsOf(reading), HasSubstr("row"));
}

TEST(LasReader, TheWktBitDecidesBetweenTwoCoordinateSystems) {
  const std::string wkt = "PROJCS[\"here\"]";
  for (const bool bit : {false, true}) {
    LasFileMaker file(4, 6, 30);
    file.addVlr("LASF_Projection", 34735, LasFileMaker::geoKeys({{1024, 1}, {3072, 2056}, {4096, 5728}}));
    file.addVlr("LASF_Projection", 2112, {wkt.begin(), wkt.end()});
    file.put<std::uint16_t>(6, bit ? 0x10 : 0);
    const auto info = LasReader().inspect(file.write("crs.las"));
    ASSERT_TRUE(info.has_value());
    EXPECT_EQ(info->crs, bit ? wkt : "EPSG:2056+5728");
    if (!bit) {
      EXPECT_THAT(info->details, HasSubstr("EPSG:5728"));
    }
  }
}

TEST(LasReader, EmptyCoordinateSystemRecordsAreNone) {
  LasFileMaker file(2, 0, 20);
  for (const std::uint16_t id : {34735, 2112}) file.addVlr("LASF_Projection", id, {});
  file.addPoint(1, 2, 3);
  const auto info = LasReader().inspect(file.write("empty_records.las"));
  ASSERT_TRUE(info.has_value()) << info.error().text();
  EXPECT_EQ(info->crs, "");
}

TEST(LasReader, AGeographicSystemAndFeetAreReadAndWarnedOf) {
  LasFileMaker degrees(2, 0, 20);
  degrees.addVlr("LASF_Projection", 34735, LasFileMaker::geoKeys({{2048, 4326}}));
  degrees.addPoint(1, 1, 1);
  std::string path = degrees.write("degrees.las");
  EXPECT_EQ(LasReader().inspect(path)->crs, "EPSG:4326");
  EXPECT_THAT(warningsOf(readAll(path)), HasSubstr("degrees"));

  LasFileMaker feet(2, 0, 20);
  feet.addVlr("LASF_Projection", 34735, LasFileMaker::geoKeys({{3072, 2994}, {3076, 9002}}));
  feet.addPoint(1, 1, 1);
  path = feet.write("feet.las");
  EXPECT_EQ(LasReader().inspect(path)->crs, "EPSG:2994");
  EXPECT_THAT(warningsOf(readAll(path)), HasSubstr("feet"));
}

TEST(LasReader, AnExtendedRecordBehindThePointsGivesTheCoordinateSystem) {
  LasFileMaker file = twoPoints(4, 6, 30);
  const std::string wkt = "PROJCS[\"behind\"]";
  file.addEvlr("somebody", 1, std::vector<std::uint8_t>(70000));
  file.addEvlr("LASF_Projection", 2112, {wkt.begin(), wkt.end()});
  file.put<std::uint16_t>(6, 0x10);
  const auto info = LasReader().inspect(file.write("evlr.las"));
  ASSERT_TRUE(info.has_value()) << info.error().text();
  EXPECT_EQ(info->crs, wkt);
  EXPECT_EQ(info->pointCount, 2u);
}

TEST(LasReader, DetailsNameVersionFormatGeneratorAndDate) {
  EXPECT_EQ(LasReader().inspect(twoPoints().write("details.las"))->details,
            "LAS 1.2, point format 3, generated by maker, 2026-02-09");
}

TEST(LasReader, ATruncatedFileNamesPromisedAndPresentCounts) {
  LasFileMaker file = twoPoints();
  file.bytes.resize(file.bytes.size() - 1);
  EXPECT_THAT(errorOf(file), HasSubstr("promises 2 points, the file holds 1"));
}

TEST(LasReader, HostileHeadersAreRefusedWithTheirReason) {
  const auto broken = [](auto change) {
    LasFileMaker file = twoPoints();
    change(file);
    return errorOf(file);
  };
  EXPECT_THAT(broken([](auto& f) { f.bytes.resize(100); }), HasSubstr("header ends after 100 bytes"));
  EXPECT_THAT(broken([](auto& f) { f.bytes.clear(); }), HasSubstr("no LAS file"));
  EXPECT_THAT(broken([](auto& f) { f.bytes[0] = 'X'; }), HasSubstr("no LAS file"));
  EXPECT_THAT(broken([](auto& f) { f.bytes[25] = 9; }), HasSubstr("version 1.9"));
  EXPECT_THAT(broken([](auto& f) { f.bytes[104] = 42; }), HasSubstr("format 42"));
  EXPECT_THAT(broken([](auto& f) { f.template put<std::uint16_t>(105, 0); }), HasSubstr("0 bytes a point"));
  EXPECT_THAT(broken([](auto& f) { f.template put<std::uint16_t>(105, 33); }), HasSubstr("at least 34"));
  EXPECT_THAT(broken([](auto& f) { f.template put<std::uint16_t>(94, 10); }), HasSubstr("10 bytes long"));
  EXPECT_THAT(broken([](auto& f) { f.template put<std::uint32_t>(96, 0xFFFFFFFF); }), HasSubstr("4294967295"));
  EXPECT_THAT(broken([](auto& f) { f.template put<std::uint32_t>(96, 0); }), HasSubstr("byte 0"));
  EXPECT_THAT(broken([](auto& f) { f.template put<std::uint32_t>(107, 0xFFFFFFFF); }), HasSubstr("4294967295 points"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(broken([&](auto& f) { f.template put<double>(139, nan); }), HasSubstr("y scale is nan"));
  EXPECT_THAT(broken([&](auto& f) { f.template put<double>(131, 0.0); }), HasSubstr("x scale is 0"));
  EXPECT_THAT(broken([&](auto& f) { f.template put<double>(147, 1e300); }), HasSubstr("1e+300"));
  EXPECT_THAT(broken([&](auto& f) { f.template put<double>(171, -1e300); }), HasSubstr("-1e+300"));
}

TEST(LasReader, ACountThatOverflowsWhenMultipliedIsRefused) {
  LasFileMaker file = twoPoints(4, 7, 36);
  file.put<std::uint64_t>(247, 0x8000000000000000ull);
  EXPECT_THAT(errorOf(file), HasSubstr("9223372036854775808 points"));
  file.put<std::uint64_t>(247, 0x71C71C71C71C71C8ull);  // times 36 it is 32 modulo 2^64
  EXPECT_THAT(errorOf(file), HasSubstr("the file holds 2"));
}

TEST(LasReader, LyingRecordsAreWarnedOfAndThePointsAreStillRead) {
  LasFileMaker file(4, 6, 30);
  file.addVlr("liar", 1, {1, 2, 3});
  const std::size_t lengthAt = 375 + 20;
  file.addPoint(1, 2, 3);
  file.put<std::uint16_t>(lengthAt, 60000);
  file.put<std::uint32_t>(100, 0xFFFFFFFF);
  Reading reading = readAll(file.write("liar.las"));
  EXPECT_EQ(reading.all.size(), 1u);
  EXPECT_THAT(warningsOf(reading), HasSubstr("record 1 of 4294967295 reaches past"));

  file.put<std::uint32_t>(243, 1000000);
  file.put<std::uint64_t>(235, 0xFFFFFFFFFFFFFFF0ull);
  reading = readAll(file.write("liar.las"));
  EXPECT_EQ(reading.all.size(), 1u);
  EXPECT_THAT(warningsOf(reading), HasSubstr("18446744073709551600"));

  file.put<std::uint64_t>(235, file.bytes.size());
  const std::vector<std::uint8_t> tail(60, 0xFF);  // an extended record of 2^64 - 1 bytes
  append(file.bytes, tail);
  reading = readAll(file.write("liar.las"));
  EXPECT_EQ(reading.all.size(), 1u);
  EXPECT_THAT(warningsOf(reading), HasSubstr("extended variable length record 1 of 1000000 reaches past"));
}

TEST(LasReader, DisagreeingCountsAndNonsenseBoundsAreWarnedOf) {
  LasFileMaker file = twoPoints(4, 6, 30);
  file.put<std::uint32_t>(107, 1);
  file.put<double>(179, std::numeric_limits<double>::quiet_NaN());
  const std::string path = file.write("disagree.las");
  const Reading reading = readAll(path);
  EXPECT_EQ(reading.all.size(), 2u);
  EXPECT_THAT(warningsOf(reading), HasSubstr("64-bit"));
  EXPECT_THAT(warningsOf(reading), HasSubstr("bounds"));
  EXPECT_TRUE(LasReader().inspect(path)->bounds.empty());
}

TEST(LasReader, CompressionThatIsNotDescribedOrUnknownIsRefused) {
  LasFileMaker byBit = twoPoints();
  byBit.bytes[104] |= 0x80;
  EXPECT_THAT(errorOf(byBit, "a.laz"), HasSubstr("record that describes how is missing"));
  LasFileMaker byRecord(2, 3, 34);
  byRecord.addVlr("laszip encoded", 22204, std::vector<std::uint8_t>(40));
  byRecord.addPoint(1, 2, 3);
  EXPECT_THAT(errorOf(byRecord, "b.laz"), HasSubstr("unknown way 0"));
}

TEST(LasReader, WavePacketsAreReadAndTheFormsThemselvesWarnedOf) {
  LasFileMaker file = twoPoints(3, 4, 57);
  const Reading reading = readAll(file.write("wave.las"));
  EXPECT_EQ(reading.all.size(), 2u);
  EXPECT_THAT(warningsOf(reading), HasSubstr("wave forms"));
}

TEST(LasReader, AMissingFileAFolderAndADeviceAreRefused) {
  EXPECT_THAT(readAll("/nowhere/at/all.las").error, HasSubstr("cannot be opened"));
  EXPECT_THAT(readAll("/tmp").error, HasSubstr("folder"));
  EXPECT_THAT(readAll("/dev/zero").error, HasSubstr("regular"));
}

TEST(LasReader, CancelStopsTheReadAndASinkMayStopItEarly) {
  LasFileMaker file(2, 0, 20);
  for (int i = 0; i < 200000; ++i) file.addPoint(i, i, i);
  const std::string path = file.write("long.las");
  Progress progress;
  int batches = 0;
  const auto cancelled = LasReader().read(
      path,
      [&](const PointBatch&) {
        ++batches;
        progress.cancel();
        return true;
      },
      progress);
  ASSERT_FALSE(cancelled.has_value());
  EXPECT_TRUE(alidade::isCancelled(cancelled.error()));
  EXPECT_EQ(batches, 1);
  batches = 0;
  const auto stopped = LasReader().read(path, [&](const PointBatch&) { return ++batches < 2; }, Progress());
  EXPECT_TRUE(stopped.has_value());
  EXPECT_EQ(batches, 2);
}

TEST(LasReader, SniffsBySignatureThenByExtension) {
  const auto probe = [](const char* extension, std::string_view head) {
    alidade::FileProbe p;
    p.extension = extension;
    p.head = std::as_bytes(std::span(head));
    return p;
  };
  EXPECT_EQ(LasReader().sniff(probe("bin", "LASF....")), 100);
  EXPECT_EQ(LasReader().sniff(probe("las", "")), 20);
  EXPECT_EQ(LasReader().sniff(probe("ply", "ply\n")), 0);
}
