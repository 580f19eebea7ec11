// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// A scan through all formats that are written, and back.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "command_line.h"
#include "io/reader_registry.h"
#include "unit/las/las_file_maker.h"

namespace alidade::test {

namespace fs = std::filesystem;

namespace {

const ReaderRegistry& registry() {
  setenv("ALIDADE_PLUGIN_PATH", ALIDADE_BINARY_DIR "/lib/alidade/plugins", 0);
  return ReaderRegistry::instance();
}

/// Every point with all its columns, as text of bytes; sorted, so that the order of the file does not tell.
std::vector<std::string> pointsOf(const fs::path& path) {
  std::vector<std::string> points;
  const auto reader = registry().findAs<ScanReader>(path.string());
  if (!reader) {
    ADD_FAILURE() << reader.error().text();
    return points;
  }
  const auto outcome = (*reader)->read(
      path.string(),
      [&](PointBatch& batch) {
        for (std::size_t i = 0; i < batch.size(); ++i) {
          std::string& point = points.emplace_back();
          const auto put = [&](const auto& column) {
            if (!column.empty()) point.append(reinterpret_cast<const char*>(&column[i]), sizeof column[i]);
          };
          put(batch.position), put(batch.rgb), put(batch.intensity), put(batch.classification), put(batch.returnNumber);
          put(batch.returnCount), put(batch.gpsTime), put(batch.scanner), put(batch.pointSource), put(batch.row), put(batch.column);
          std::vector<const ExtraColumn*> extra;
          for (const ExtraColumn& column : batch.extra) extra.push_back(&column);
          std::ranges::sort(extra, {}, &ExtraColumn::name);
          for (const ExtraColumn* column : extra)
            point += column->name + std::string(reinterpret_cast<const char*>(&column->data[i * column->bytesPerPoint()]), column->bytesPerPoint());
        }
        return true;
      },
      Progress());
  EXPECT_TRUE(outcome.has_value()) << (outcome ? "" : outcome.error().text());
  std::ranges::sort(points);
  return points;
}

void expectConverted(const fs::path& from, const fs::path& to) {
  const auto outcome = alidadeCli("convert --json " + quoted(from) + " -o " + quoted(to));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.errors;
}

nlohmann::json infoOf(const fs::path& path) {
  const auto outcome = alidadeCli("info --json " + quoted(path));
  EXPECT_EQ(outcome.exitCode, 0) << outcome.errors;
  return outcome.json()["files"][0];
}

}  // namespace

TEST(Convert, LazCopcStoreAndBackKeepsEveryPointAndWhatTheHeaderSays) {
  const fs::path las = smallDemo() / "scan.las";
  const fs::path laz = scratch() / "round.laz", copc = scratch() / "round.copc.laz", store = scratch() / "round.alidade-points";
  const fs::path again = scratch() / "again.copc.laz", back = scratch() / "back.las";
  expectConverted(las, laz);
  expectConverted(laz, copc);
  ASSERT_EQ(alidadeCli("index " + quoted(copc) + " -o " + quoted(store)).exitCode, 0);
  EXPECT_TRUE(fs::exists(store / "part-0001/surface.bin")) << "what the stations saw is kept beside the points";
  expectConverted(store, again);
  expectConverted(store, back);
  const auto source = pointsOf(las);
  ASSERT_GT(source.size(), 10000u);
  for (const fs::path& path : {laz, copc, again, back}) EXPECT_TRUE(pointsOf(path) == source) << path;
  const auto first = infoOf(las);
  for (const fs::path& path : {laz, copc, again, back}) {
    const auto info = infoOf(path);
    for (const char* field : {"points", "bounds_m", "crs"}) EXPECT_EQ(info[field], first[field]) << path << ' ' << field;
    EXPECT_EQ(info["stations"].size(), first["stations"].size()) << path;
  }
  // What was made for the while is gone.
  EXPECT_FALSE(fs::exists(copc.string() + ".alidade-points"));
}

TEST(Convert, AStoreOfSeveralScansBecomesOneTree) {
  const auto grid = [](const std::string& name, double height) {
    const auto path = scratch() / name;
    std::ofstream out(path);
    for (int x = 0; x < 200; ++x)
      for (int y = 0; y < 200; ++y) out << 2683500 + 0.5 * x << ' ' << 1247800 + 0.5 * y << ' ' << height << '\n';
    return path;
  };
  const fs::path store = scratch() / "two.alidade-points", copc = scratch() / "two.copc.laz";
  ASSERT_EQ(alidadeCli("index " + quoted(grid("one.xyz", 400)) + ' ' + quoted(grid("two.xyz", 410)) + " -o " + quoted(store)).exitCode, 0);
  expectConverted(store, copc);
  const auto reader = registry().findAs<ScanReader>(copc.string());
  ASSERT_TRUE(reader.has_value());
  // The tree's top is an even picture of all: about one point in ten, from both scans, nowhere far apart.
  std::size_t low = 0, high = 0;
  const auto sampled = (*reader)->sample(
      copc.string(), 8000,
      [&](PointBatch& batch) {
        for (const glm::dvec3& p : batch.position) (p.z < 405 ? low : high)++;
        return true;
      },
      Progress());
  ASSERT_TRUE(sampled.has_value());
  EXPECT_GT(low, 2000u);
  EXPECT_GT(high, 2000u);
  EXPECT_LT(low + high, 20000u);
  EXPECT_EQ(pointsOf(copc).size(), 80000u);
}

// Places of the fields: LAS 1.4 R15, tables 3, 7 and 24.
TEST(Convert, WhatAFileSaysBesideItsPointsGoesThroughAStore) {
  testing::LasFileMaker file(2, 1, 30);
  std::vector<std::uint8_t> entry = testing::LasFileMaker::extraBytes("height_above", 3, 0x18);
  const double scale = 0.01, offset = -5;
  std::memcpy(&entry[112], &scale, 8), std::memcpy(&entry[136], &offset, 8);
  file.addVlr("LASF_Spec", 4, entry);
  file.addVlr("MyCompany", 77, {'p', 'r', 'e', 'c', 'i', 'o', 'u', 's'});
  file.addVlr("LASF_Projection", 34735, testing::LasFileMaker::geoKeys({{1024, 1}, {3072, 2056}, {4096, 5728}}));
  file.put<std::uint16_t>(6, 1);
  for (int i = 0; i < 1000; ++i) file.addPoint(i * 37 % 1000, i * 91 % 1000, i);
  const fs::path store = scratch() / "notes.alidade-points", las = scratch() / "notes.las", copc = scratch() / "notes.copc.laz";
  const fs::path source = file.write("notes_source.las");
  ASSERT_EQ(alidadeCli("index " + quoted(source) + " -o " + quoted(store)).exitCode, 0);
  expectConverted(store, las);
  expectConverted(source, copc);
  for (const fs::path& path : {las, copc}) {
    std::ifstream in(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    EXPECT_NE(bytes.find(std::string(entry.begin(), entry.end())), std::string::npos) << path;
    EXPECT_NE(bytes.find("precious"), std::string::npos) << path;
    EXPECT_EQ(bytes[6] & 1, 1) << path << ": standard GPS time";
    EXPECT_EQ(infoOf(path)["crs"], "EPSG:2056+5728") << path;
  }
}

TEST(Convert, AScanThatSaysItsHeightsSystemJoinsOneThatDoesNot) {
  const auto scanOf = [](const std::string& name, std::uint16_t plane, std::uint16_t heights) {
    testing::LasFileMaker file(2, 0, 20);
    file.addVlr("LASF_Projection", 34735,
                heights > 0 ? testing::LasFileMaker::geoKeys({{1024, 1}, {3072, plane}, {4096, heights}})
                            : testing::LasFileMaker::geoKeys({{1024, 1}, {3072, plane}}));
    for (int i = 0; i < 10; ++i) file.addPoint(i, i, i);
    return file.write(name);
  };
  const fs::path plain = scanOf("plain.las", 2056, 0), high = scanOf("high.las", 2056, 5728), other = scanOf("other.las", 25832, 0);
  const fs::path both = scratch() / "both.las";
  const auto joined = alidadeCli("convert " + quoted(plain) + ' ' + quoted(high) + " -o " + quoted(both));
  ASSERT_EQ(joined.exitCode, 0) << joined.errors;
  EXPECT_EQ(infoOf(both)["crs"], "EPSG:2056+5728");
  EXPECT_EQ(alidadeCli("convert " + quoted(plain) + ' ' + quoted(other) + " -o " + quoted(scratch() / "never.las")).exitCode, 1);
}

TEST(Convert, FloatingCoordinatesAreWrittenInFineSteps) {
  const fs::path text = scratch() / "fine.xyz", las = scratch() / "fine.las";
  std::ofstream(text) << "2683512.12345678 1247811.98765432 413.1\n2683514.5 1247813.25 414.12345678\n";
  expectConverted(text, las);
  const auto reader = registry().findAs<ScanReader>(las.string());
  ASSERT_TRUE(reader.has_value());
  std::vector<glm::dvec3> points;
  const auto read = (*reader)->read(
      las.string(),
      [&](PointBatch& batch) {
        points.insert(points.end(), batch.position.begin(), batch.position.end());
        return true;
      },
      Progress());
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(points.size(), 2u);
  EXPECT_NEAR(points[0].x, 2683512.12345678, 1e-8);
  EXPECT_NEAR(points[0].y, 1247811.98765432, 1e-8);
  EXPECT_NEAR(points[1].z, 414.12345678, 1e-8);
}

TEST(Info, DegreesAreSaidAndHaveNoDensity) {
  testing::LasFileMaker file(2, 0, 20);
  file.addVlr("LASF_Projection", 34735, testing::LasFileMaker::geoKeys({{1024, 2}, {2048, 4326}}));
  file.addPoint(1, 2, 3), file.addPoint(1000, 2000, 3);
  for (int axis = 0; axis < 3; ++axis) file.put<double>(static_cast<std::size_t>(179 + 16 * axis), 2.0);
  const fs::path path = file.write("degrees.las");
  const auto outcome = alidadeCli("info " + quoted(path));
  EXPECT_NE(outcome.output.find("degrees of latitude"), std::string::npos) << outcome.output;
  EXPECT_EQ(outcome.output.find("square metre"), std::string::npos) << outcome.output;
  EXPECT_TRUE(infoOf(path)["points_per_square_metre"].is_null());
  EXPECT_EQ(infoOf(path)["warnings"].size(), 1u);
}

TEST(Convert, RefusesItselfWhatIsThereAndWhatIsEmpty) {
  const fs::path las = smallDemo() / "scan.las";
  EXPECT_EQ(alidadeCli("convert --overwrite " + quoted(las) + " -o " + quoted(las)).exitCode, 1);
  const fs::path there = scratch() / "there.laz";
  std::ofstream(there) << "kept";
  EXPECT_EQ(alidadeCli("convert " + quoted(las) + " -o " + quoted(there)).exitCode, 1);
  EXPECT_EQ(fs::file_size(there), 4u);
  EXPECT_EQ(alidadeCli("convert " + quoted(las) + " -o " + quoted(scratch() / "scan.e57")).exitCode, 1);
  EXPECT_EQ(alidadeCli("convert " + quoted(scratch() / "none.las") + " -o " + quoted(scratch() / "x.copc.laz")).exitCode, 1);
  EXPECT_FALSE(fs::exists(scratch() / "x.copc.laz"));
}

// ALIDADE_LAZ_PERF names a folder with node_modules/laz-perf (npm install laz-perf); development only.
TEST(Convert, AnIndependentDecoderReadsTheSamePoints) {
  const char* folder = std::getenv("ALIDADE_LAZ_PERF");
  if (!folder) GTEST_SKIP() << "ALIDADE_LAZ_PERF is not set: laz-perf is not asked";
  const fs::path las = smallDemo() / "scan.las", copc = scratch() / "independent.copc.laz";
  expectConverted(las, copc);
  const auto info = (*registry().findAs<ScanReader>(las.string()))->inspect(las.string());
  ASSERT_TRUE(info.has_value());
  std::uint64_t count = 0;
  double sum = 0;
  const auto read = (*registry().findAs<ScanReader>(las.string()))->read(
      las.string(),
      [&](PointBatch& batch) {
        for (const glm::dvec3& p : batch.position) {
          const glm::i64vec3 at(glm::round((p - info->offset) / info->scale));
          sum += static_cast<std::uint32_t>(at.x) * 73856093u ^ static_cast<std::uint32_t>(at.y) * 19349663u ^
                 static_cast<std::uint32_t>(at.z) * 83492791u;
          ++count;
        }
        return true;
      },
      Progress());
  ASSERT_TRUE(read.has_value());
  const fs::path out = scratch() / "laz_perf.json";
  const std::string command = "NODE_PATH=" + quoted(fs::path(folder) / "node_modules") + " node " +
                              quoted(fs::path(ALIDADE_SOURCE_DIR) / "tests/cli/laz_perf_sum.js") + ' ' + quoted(copc) + " > " + quoted(out);
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::ifstream file(out);
  const auto json = nlohmann::json::parse(file);
  EXPECT_EQ(json["count"], count);
  EXPECT_EQ(json["sum"].get<double>(), sum);
}

}  // namespace alidade::test
