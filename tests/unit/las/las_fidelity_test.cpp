// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What a file says beside its points, written again. Places and meanings of bytes are those of LAS 1.4 R15.

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

#include "las/las_crs.h"
#include "las/las_writer.h"
#include "unit/las/all_points.h"
#include "unit/las/las_file_maker.h"

using alidade::ColumnMeaning;
using alidade::ExtraColumn;
using alidade::GpsTimeKind;
using alidade::LasFormatWriter;
using alidade::LasReader;
using alidade::NumberType;
using alidade::PointBatch;
using alidade::ScanNotes;
using alidade::ScanWriteOptions;
using alidade::testing::AllPoints;
using alidade::testing::LasFileMaker;
using alidade::testing::readEverything;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace {

std::string textOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class T>
T numberAt(const std::string& file, std::size_t offset) {
  T value;
  std::memcpy(&value, file.data() + offset, sizeof value);
  return value;
}

/// A record's payload before the points; empty where there is none.
std::string recordOf(const std::string& file, const std::string& user, std::uint16_t id) {
  std::size_t at = numberAt<std::uint16_t>(file, 94);
  for (std::uint32_t i = 0; i < numberAt<std::uint32_t>(file, 100); ++i) {
    const std::size_t length = numberAt<std::uint16_t>(file, at + 20);
    if (file.compare(at + 2, user.size(), user) == 0 && numberAt<std::uint16_t>(file, at + 18) == id) return file.substr(at + 54, length);
    at += 54 + length;
  }
  return {};
}

struct Written {
  std::string file;  ///< its bytes
  AllPoints points;
  ScanNotes notes;
  alidade::ScanInfo info;
  std::vector<std::string> remarks;
};

Written writeLas(const PointBatch& batch, const ScanWriteOptions& options, const std::string& name) {
  Written out;
  const std::string path = LasFileMaker(2, 0, 20).write(name);
  auto sink = LasFormatWriter(LasFormatWriter::Kind::Las).create(path, options);
  EXPECT_TRUE(sink.has_value());
  EXPECT_TRUE((*sink)->add(batch, {}).has_value());
  EXPECT_TRUE((*sink)->finish().has_value());
  out.remarks = (*sink)->remarks();
  out.file = textOf(path);
  out.points = readEverything(path);
  out.notes = *LasReader().notes(path);
  out.info = *LasReader().inspect(path);
  return out;
}

/// What a file holds, written again as it says.
Written again(const std::string& path) {
  ScanWriteOptions options;
  options.info = *LasReader().inspect(path);
  options.notes = *LasReader().notes(path);
  return writeLas(readEverything(path).all, options, "again.las");
}

std::vector<std::uint8_t> joined(std::vector<std::uint8_t> a, const std::vector<std::uint8_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

int byteOf(const AllPoints& points, const std::string& column) {
  const ExtraColumn* extra = points.extra(column);
  return extra ? std::to_integer<int>(extra->data.at(0)) : -1;
}

}  // namespace

TEST(LasFidelity, ColumnsOfOneNameAreAllKept) {
  LasFileMaker file(2, 0, 24);
  std::vector<std::uint8_t> record;
  for (const char* name : {"a", "a", "intensity", "user_data"}) record = joined(record, LasFileMaker::extraBytes(name, 1));
  file.addVlr("LASF_Spec", 4, record);
  const std::size_t at = file.addPoint(1, 2, 3);
  file.put<std::uint16_t>(at + 12, 500);
  file.put<std::uint8_t>(at + 17, 77);
  for (std::uint8_t i = 0; i < 4; ++i) file.put<std::uint8_t>(at + 20 + i, static_cast<std::uint8_t>(10 + i));
  const std::string path = file.write("names.las");
  const Written written = again(path);
  for (const AllPoints& points : {readEverything(path), written.points}) {
    EXPECT_THAT(points.all.intensity, ElementsAre(500));
    EXPECT_EQ(byteOf(points, "user_data"), 77);
    EXPECT_EQ(byteOf(points, "a"), 10);
    EXPECT_EQ(byteOf(points, "a_2"), 11);
    EXPECT_EQ(byteOf(points, "intensity_2"), 12);
    EXPECT_EQ(byteOf(points, "user_data_2"), 13);
  }
  EXPECT_THAT(LasReader().notes(path)->warnings, Contains(HasSubstr("\"user_data_2\"")));
}

TEST(LasFidelity, TheWriterTellsColumnsOfOneNameApart) {
  PointBatch batch;
  batch.position = {{1, 2, 3}};
  batch.row = {5}, batch.column = {6};
  const auto column = [](const char* name, int value) { return ExtraColumn{name, NumberType::U8, 1, {static_cast<std::byte>(value)}}; };
  batch.extra = {column("user_data", 1), column("user_data", 2), column("row", 3), column("x", 4), column("x", 5)};
  const Written written = writeLas(batch, {}, "apart.las");
  EXPECT_EQ(byteOf(written.points, "user_data"), 1);
  EXPECT_EQ(byteOf(written.points, "user_data_2"), 2);
  EXPECT_EQ(byteOf(written.points, "row_2"), 3);
  EXPECT_EQ(byteOf(written.points, "x"), 4);
  EXPECT_EQ(byteOf(written.points, "x_2"), 5);
  EXPECT_THAT(written.points.all.row, ElementsAre(5u));
  EXPECT_THAT(written.remarks, Contains(HasSubstr("\"row_2\"")));
}

TEST(LasFidelity, WhatExtraBytesMeanIsKept) {
  std::vector<std::uint8_t> entry = LasFileMaker::extraBytes("height_above", 3, 0x1F);
  const auto put = [&](std::size_t at, auto value) { std::memcpy(&entry[at], &value, sizeof value); };
  put(40, std::uint64_t{65535}), put(64, std::uint64_t{2}), put(88, std::uint64_t{60000});
  put(112, 0.01), put(136, -5.0);
  std::memcpy(&entry[160], "metres above ground", 19);
  LasFileMaker file(2, 0, 22);
  file.addVlr("LASF_Spec", 4, entry);
  file.put<std::uint16_t>(file.addPoint(1, 2, 3) + 20, 10000);
  const Written written = again(file.write("scaled.las"));
  ASSERT_EQ(written.notes.columns.size(), 1u);
  const ColumnMeaning& meaning = written.notes.columns[0];
  EXPECT_EQ(meaning.column, "height_above");
  EXPECT_EQ(meaning.scale.x * 10000 + meaning.offset.x, 95.0);
  const std::string record = recordOf(written.file, "LASF_Spec", 4);
  EXPECT_EQ(record, std::string(entry.begin(), entry.end()));
}

TEST(LasFidelity, TheKindOfGpsTimesIsKept) {
  for (const auto& [minor, format, length] : {std::tuple{2, 1, 28}, std::tuple{4, 6, 30}})
    for (const bool standard : {false, true}) {
      LasFileMaker file(minor, format, static_cast<std::uint16_t>(length));
      file.put<std::uint16_t>(6, standard ? 1 : 0);
      file.addPoint(1, 2, 3);
      const Written written = again(file.write("times.las"));
      EXPECT_EQ(numberAt<std::uint16_t>(written.file, 6) & 1, standard ? 1 : 0) << format;
      EXPECT_EQ(written.notes.gpsTime, standard ? GpsTimeKind::Standard : GpsTimeKind::OfWeek);
    }
}

TEST(LasFidelity, AnEpsgSystemWithHeightsIsWrittenAsKeysAndAsWkt) {
  for (const auto& [minor, format, length] : {std::tuple{2, 0, 20}, std::tuple{4, 6, 30}}) {
    LasFileMaker file(minor, format, static_cast<std::uint16_t>(length));
    file.addVlr("LASF_Projection", 34735, LasFileMaker::geoKeys({{1024, 1}, {3072, 2056}, {3076, 9001}, {4096, 5728}}));
    file.addPoint(1, 2, 3);
    const Written written = again(file.write("heights.las"));
    EXPECT_EQ(written.info.crs, "EPSG:2056+5728") << format;
    const std::string wkt = recordOf(written.file, "LASF_Projection", 2112), keys = recordOf(written.file, "LASF_Projection", 34735);
    EXPECT_EQ((numberAt<std::uint16_t>(written.file, 6) & 16) != 0, format == 6);
    EXPECT_EQ(wkt.empty(), format == 0);
    EXPECT_EQ(keys.empty(), format == 6);
    if (format == 6) {
      EXPECT_THAT(wkt, HasSubstr("COMPD_CS["));
      EXPECT_THAT(wkt, HasSubstr("AUTHORITY[\"EPSG\",\"2056\"]"));
      EXPECT_THAT(wkt, HasSubstr("AUTHORITY[\"EPSG\",\"5728\"]"));
    }
    EXPECT_THAT(written.remarks, IsEmpty());
  }
}

TEST(LasFidelity, AnUnknownEpsgSystemIsWrittenAsKeysAndSaidSo) {
  PointBatch batch;
  batch.position = {{1, 2, 3}};
  ScanWriteOptions options;
  options.info.crs = "EPSG:1";
  const Written written = writeLas(batch, options, "unknown.las");
  EXPECT_EQ(written.info.crs, "EPSG:1");
  EXPECT_THAT(written.remarks, Contains(HasSubstr("EPSG:1")));
}

// EPSG: the international foot is 0.3048 m, the US survey foot 1200/3937 m; whatever a WKT calls them.
TEST(LasFidelity, TheUnitIsTheWktsNumber) {
  const auto wkt = [](const char* unit) {
    return std::string("PROJCS[\"p\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],"
                       "UNIT[\"Degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],"
                       "PARAMETER[\"central_meridian\",9],PARAMETER[\"scale_factor\",1],PARAMETER[\"false_easting\",0],"
                       "PARAMETER[\"false_northing\",0],") + unit + "]";
  };
  const auto warningsOf = [](const std::string& text) {
    LasFileMaker file(4, 6, 30);
    file.addVlr("LASF_Projection", 2112, {text.begin(), text.end()});
    file.put<std::uint16_t>(6, 16);
    file.addPoint(1, 2, 3);
    std::string all;
    const auto notes = LasReader().notes(file.write("unit.las"));
    for (const std::string& warning : notes->warnings) all += warning + '\n';
    return all;
  };
  EXPECT_EQ(warningsOf(wkt("UNIT[\"metre\",1]")), "");
  EXPECT_EQ(warningsOf(wkt("UNIT[\"Meter\",1.0]")), "");
  EXPECT_THAT(warningsOf(wkt("UNIT[\"US survey foot\",0.304800609601219]")), HasSubstr("in feet"));
  EXPECT_THAT(warningsOf(wkt("UNIT[\"Foot_US\",0.3048006096012192]")), HasSubstr("in feet"));
  EXPECT_THAT(warningsOf(wkt("UNIT[\"FOOT\",0.3048]")), HasSubstr("in feet"));
  EXPECT_THAT(warningsOf(wkt("UNIT[\"barefoot metre\",1]")), ::testing::Not(HasSubstr("feet")));
}

TEST(LasFidelity, RecordsOfOthersAreHandedOn) {
  LasFileMaker file(2, 0, 20);
  file.addVlr("MyCompany", 77, {'p', 'r', 'e', 'c', 'i', 'o', 'u', 's'});
  file.addPoint(1, 2, 3);
  EXPECT_EQ(recordOf(again(file.write("others.las")).file, "MyCompany", 77), "precious");
}

TEST(LasFidelity, FloatingCoordinatesTakeTheFinestStepsThatReach) {
  PointBatch batch;
  batch.position = {{2683512.123456789, 1247811.987654321, 413.1}, {2683513.5, 1247812.25, 414.123456789}};
  ScanWriteOptions options;
  for (const auto& p : batch.position) options.info.bounds.add(p);
  Written written = writeLas(batch, options, "fine.las");
  EXPECT_NEAR(written.info.scale.x, 1e-9, 1e-24);
  for (std::size_t i = 0; i < 2; ++i)
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(written.points.all.position[i][axis], batch.position[i][axis], 1e-9);
  // Over 30 km 32 bits reach for steps of 1e-4 m, with reserve; what is rounded then is said.
  batch.position.push_back({2713512.00001234, 1247811, 400});
  options.info.bounds.add(batch.position.back());
  written = writeLas(batch, options, "wide.las");
  EXPECT_NEAR(written.info.scale.x, 1e-4, 1e-15);
  EXPECT_THAT(written.remarks, Contains(HasSubstr("rounded to steps of 0.0001 m")));
  // Numbers that the steps hold are not rounded.
  batch.position = {{2683512.1234, 1247811.5, 413.1}, {2713512.4321, 1247811, 400}};
  EXPECT_THAT(writeLas(batch, options, "even.las").remarks, IsEmpty());
}
