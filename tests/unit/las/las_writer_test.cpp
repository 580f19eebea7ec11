// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_writer.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "base/parallel.h"
#include "las/copc_hierarchy.h"
#include "unit/las/all_points.h"
#include "unit/las/las_file_maker.h"

namespace fs = std::filesystem;
using alidade::ExtraColumn;
using alidade::LasFormatWriter;
using alidade::LasReader;
using alidade::NumberType;
using alidade::OctreeCell;
using alidade::PointBatch;
using alidade::ScanInfo;
using alidade::ScanWriteOptions;
using alidade::testing::AllPoints;
using alidade::testing::expectSamePoints;
using alidade::testing::LasFileMaker;
using alidade::testing::readEverything;
using ::testing::HasSubstr;
using Kind = LasFormatWriter::Kind;

namespace {

const fs::path kData(ALIDADE_SHARED_DATA_DIR);

std::string pathFor(const std::string& name) {
  return LasFileMaker(2, 0, 20).write(name);
}

std::string writeAll(Kind kind, const std::string& path, const ScanWriteOptions& options,
                     const std::vector<std::pair<PointBatch, std::optional<OctreeCell>>>& parts) {
  auto sink = LasFormatWriter(kind).create(path, options);
  if (!sink) return sink.error().text();
  for (const auto& [batch, cell] : parts)
    if (auto ok = (*sink)->add(batch, cell); !ok) return ok.error().text();
  const auto done = (*sink)->finish();
  return done ? "" : done.error().text();
}

ScanWriteOptions optionsOf(const std::string& path) {
  ScanWriteOptions options;
  options.info = *LasReader().inspect(path);
  return options;
}

template <class T>
ExtraColumn column(const std::string& name, NumberType type, int components, const std::vector<T>& values) {
  ExtraColumn out{name, type, components, {}};
  out.data.resize(values.size() * sizeof(T));
  std::memcpy(out.data.data(), values.data(), out.data.size());
  return out;
}

/// Points of every column whose numbers jump about, so that every branch of the coders is taken: changes of scanner
/// channel, returns, angles, huge and repeated times, wide coordinates.
PointBatch wildPoints(std::size_t count, bool old, bool colour, bool infrared, bool wave) {
  std::mt19937_64 random(count + old);
  const auto below = [&](std::uint64_t n) { return random() % n; };
  PointBatch batch;
  batch.rgbWhite = 65535;
  std::vector<std::uint8_t> flags, user, waves, tiny;
  std::vector<std::int8_t> ranks;
  std::vector<std::int16_t> angles;
  std::vector<std::uint16_t> nir;
  std::vector<double> doubles;
  glm::i64vec3 at(0);
  double time = 1000;
  glm::u16vec3 rgb(30000);
  for (std::size_t i = 0; i < count; ++i) {
    const auto step = [&] { return static_cast<std::int64_t>(below(1ull << below(30))) - static_cast<std::int64_t>(below(1ull << below(30))); };
    at += glm::i64vec3(step(), step(), step());
    if (below(50) == 0) at = glm::i64vec3(below(1u << 31), -static_cast<std::int64_t>(below(1u << 31)), 0);
    for (int axis = 0; axis < 3; ++axis) at[axis] = std::clamp<std::int64_t>(at[axis], INT32_MIN, INT32_MAX);
    batch.position.push_back(glm::dvec3(0.001) * glm::dvec3(at) + glm::dvec3(2600000, 1200000, 400));
    batch.intensity.push_back(static_cast<std::uint16_t>(below(3) ? 700 + below(9) : random()));
    batch.classification.push_back(static_cast<std::uint8_t>(below(4) ? 2 : below(old ? 32 : 256)));
    const unsigned returns = 1 + static_cast<unsigned>(below(old ? 7 : 15));
    batch.returnCount.push_back(static_cast<std::uint8_t>(below(2) ? 1 : returns));
    batch.returnNumber.push_back(static_cast<std::uint8_t>(1 + below(batch.returnCount.back())));
    batch.pointSource.push_back(static_cast<std::uint16_t>(below(9) ? 17 : random()));
    if (below(3)) time += 1e-5 * static_cast<double>(below(below(9) ? 4 : 2000));
    if (below(200) == 0) time = static_cast<double>(below(1u << 30)) - 5e8;
    batch.gpsTime.push_back(below(40) == 0 ? time + 1e6 : time);
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint16_t>(below(4) ? rgb[c] + below(600) - 300 : random());
    if (below(5) == 0) rgb = glm::u16vec3(rgb.x);
    if (colour) batch.rgb.push_back(rgb);
    batch.row.push_back(static_cast<std::uint32_t>(i % 100));
    batch.column.push_back(static_cast<std::uint32_t>(i / 100));
    flags.push_back(static_cast<std::uint8_t>(below(5) ? 0 : random() & (old ? 0xC7 : 0xFF)));
    user.push_back(static_cast<std::uint8_t>(below(4) ? 1 : random()));
    ranks.push_back(static_cast<std::int8_t>(below(3) ? 12 : random()));
    angles.push_back(static_cast<std::int16_t>(below(3) ? -2000 : random()));
    nir.push_back(static_cast<std::uint16_t>(below(2) ? 9 : random()));
    for (int b = 0; b < 29; ++b) waves.push_back(static_cast<std::uint8_t>(below(6) ? 3 : random()));
    doubles.push_back(static_cast<double>(random()));
    for (int b = 0; b < 3; ++b) tiny.push_back(static_cast<std::uint8_t>(random()));
  }
  batch.extra.push_back(column("scan_flags", NumberType::U8, 1, flags));
  if (old)
    batch.extra.push_back(column("scan_angle_rank", NumberType::I8, 1, ranks));
  else
    batch.extra.push_back(column("scan_angle", NumberType::I16, 1, angles));
  batch.extra.push_back(column("user_data", NumberType::U8, 1, user));
  if (infrared) batch.extra.push_back(column("nir", NumberType::U16, 1, nir));
  if (wave) batch.extra.push_back(column("wave_packet", NumberType::U8, 29, waves));
  batch.extra.push_back(column("Range", NumberType::F64, 1, doubles));
  batch.extra.push_back(column("Triple", NumberType::U8, 3, tiny));
  return batch;
}

ScanWriteOptions wildOptions() {
  ScanWriteOptions options;
  options.info.scale = glm::dvec3(0.001);
  options.info.offset = {2600000, 1200000, 400};
  return options;
}

struct Variant {
  const char* what;
  bool old, colour, infrared, wave;
  int format;
};
constexpr Variant kVariants[] = {{"3", true, true, false, false, 3},    {"1", true, false, false, false, 1},
                                 {"5", true, true, false, true, 5},     {"6", false, false, false, false, 6},
                                 {"7", false, true, false, false, 7},   {"8", false, true, true, false, 8},
                                 {"9", false, false, false, true, 9},   {"10", false, true, true, true, 10}};

}  // namespace

TEST(LasWriter, EveryColumnOfEveryFormatComesBackFromLasAndLazBitForBit) {
  for (const Variant& v : kVariants) {
    const PointBatch points = wildPoints(60000, v.old, v.colour, v.infrared, v.wave);
    for (const Kind kind : {Kind::Las, Kind::Laz}) {
      const std::string path = pathFor(kind == Kind::Las ? "wild.las" : "wild.laz");
      ASSERT_EQ(writeAll(kind, path, wildOptions(), {{points, {}}}), "") << v.what;
      const auto info = LasReader().inspect(path);
      ASSERT_TRUE(info.has_value()) << info.error().text();
      EXPECT_THAT(info->details, HasSubstr(fmt::format("point format {}", v.format)));
      const AllPoints read = readEverything(path);
      EXPECT_EQ(read.error, "");
      expectSamePoints(read.all, points, fmt::format("format {}, {}", v.what, path));
      for (const auto& warning : read.warnings) EXPECT_THAT(warning.what, ::testing::Not(HasSubstr("bounds")));
    }
  }
}

TEST(LasWriter, RealFilesComeBackBitForBitThroughEachFormat) {
  if (!fs::exists(kData / "las")) GTEST_SKIP() << "SKIPPED: no real data at " << kData;
  for (const char* name : {"las/las-rs/point-time-color.las", "las/las-rs/extra-bytes.las", "las/laspy/autzen_trim.laz",
                           "las/laspy/vegetation_1_3.las", "las/laspy/1_4_w_evlr.laz", "copc/ellipsoid-1.4.laz",
                           "las/laspy/fullwave.laz", "las/laspy/append-bug.laz"}) {
    const std::string source = (kData / name).string();
    const AllPoints original = readEverything(source);
    ASSERT_EQ(original.error, "");
    const bool spread = original.all.rgbWhite == 255;  // 8-bit colours become 16-bit ones
    for (const Kind kind : {Kind::Las, Kind::Laz}) {
      const std::string path = pathFor(kind == Kind::Las ? "real.las" : "real.laz");
      ASSERT_EQ(writeAll(kind, path, optionsOf(source), {{original.all, {}}}), "") << name;
      AllPoints read = readEverything(path);
      EXPECT_EQ(read.error, "") << name;
      if (spread) {
        for (auto& rgb : read.all.rgb) rgb /= std::uint16_t{257};
      }
      expectSamePoints(read.all, original.all, name);
      EXPECT_EQ(LasReader().inspect(path)->crs, LasReader().inspect(source)->crs) << name;
    }
  }
}

TEST(LasWriter, ColumnsThatComeAndGoWithTheBatchesAreRefusedAndNothingIsLeftBehind) {
  const std::string path = pathFor("mixed.laz");
  fs::remove(path);
  PointBatch plain;
  plain.position = {{1, 2, 3}};
  PointBatch timed = plain;
  timed.gpsTime = {5};
  timed.rgb = {{1, 2, 3}};
  EXPECT_THAT(writeAll(Kind::Laz, path, {}, {{plain, {}}, {timed, {}}}), HasSubstr("colours"));
  EXPECT_FALSE(fs::exists(path));
  for (const auto& entry : fs::directory_iterator(fs::path(path).parent_path()))
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST(LasWriter, CoordinatesTooFarFromTheOffsetAreRefused) {
  PointBatch batch;
  batch.position = {{0, 0, 0}, {1e9, 0, 0}};
  ScanWriteOptions options = wildOptions();
  EXPECT_THAT(writeAll(Kind::Las, pathFor("far.las"), options, {{batch, {}}}), HasSubstr("too far"));
}

TEST(LasWriter, AFileWithoutPointsIsAFile) {
  for (const Kind kind : {Kind::Las, Kind::Laz}) {
    const std::string path = pathFor("none.laz");
    ASSERT_EQ(writeAll(kind, path, {}, {}), "");
    const AllPoints read = readEverything(path);
    EXPECT_EQ(read.error, "");
    EXPECT_EQ(read.all.size(), 0u);
  }
}

TEST(LasWriter, StationsComeBackWithTheirPosesAndGrids) {
  ScanWriteOptions options = wildOptions();
  for (int i = 0; i < 3; ++i) {
    alidade::Station station;
    station.name = fmt::format("Ständpunkt \"{}\"", i);
    station.rows = 1000u + static_cast<unsigned>(i);
    station.columns = 2000;
    station.worldFromScanner.rotation = glm::normalize(glm::dquat(0.3, 0.1 * i, 0.2, 0.9));
    station.worldFromScanner.translation = {2600000.1 + i, 1200000.123456789, 400.5};
    options.info.stations.push_back(station);
  }
  PointBatch batch = wildPoints(1000, false, true, false, false);
  for (std::size_t i = 0; i < batch.size(); ++i) batch.scanner.push_back(static_cast<std::uint16_t>(i % 3));
  const std::string path = pathFor("stations.laz");
  ASSERT_EQ(writeAll(Kind::Laz, path, options, {{batch, {}}}), "");
  const auto info = LasReader().inspect(path);
  ASSERT_EQ(info->stations.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const auto& a = info->stations[i];
    const auto& b = options.info.stations[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.rows, b.rows);
    EXPECT_EQ(a.columns, b.columns);
    EXPECT_EQ(a.worldFromScanner.translation, b.worldFromScanner.translation);
    EXPECT_EQ(a.worldFromScanner.rotation, b.worldFromScanner.rotation);
  }
  EXPECT_EQ(readEverything(path).all.scanner, batch.scanner);
}

namespace {

/// An octree by hand: every point in the cell of a random depth that its place falls to.
std::map<std::array<int, 4>, PointBatch> inCells(const PointBatch& points, const glm::dvec3& corner, double size) {
  std::map<std::array<int, 4>, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int depth = static_cast<int>(i * 7919 % 4);
    const glm::dvec3 cell = glm::floor((points.position[i] - corner) / size * static_cast<double>(1 << depth));
    members[{depth, static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z)}].push_back(i);
  }
  std::map<std::array<int, 4>, PointBatch> cells;
  for (const auto& [key, indices] : members)
    for (const std::size_t i : indices) alidade::testing::appendBatch(cells[key], points.every(i, points.size()));
  return cells;
}

}  // namespace

TEST(CopcWriter, EveryNodeComesBackByTheHierarchyAndAllPointsByTheChunks) {
  const PointBatch points = wildPoints(3000, false, true, true, false);
  ScanWriteOptions options = wildOptions();
  options.info.crs = "PROJCS[\"here\"]";
  options.cubeCorner = options.info.offset - 3e6;
  options.cubeSize = 6e6;
  options.rootSpacing = 1000;
  const auto cells = inCells(points, options.cubeCorner, options.cubeSize);
  std::vector<std::pair<PointBatch, std::optional<OctreeCell>>> parts;
  PointBatch inOrder;
  for (const auto& [key, batch] : cells) {
    parts.push_back({batch, OctreeCell{key[0], key[1], key[2], key[3]}});
    alidade::testing::appendBatch(inOrder, batch);
  }
  const std::string path = pathFor("site.copc.laz");
  ASSERT_EQ(writeAll(Kind::Copc, path, options, parts), "");
  expectSamePoints(readEverything(path).all, inOrder, "by chunks");

  const auto file = alidade::ByteSource::open(path);
  const auto header = alidade::readLasHeader(**file);
  ASSERT_TRUE(header.has_value() && header->copc);
  EXPECT_EQ(header->crs, options.info.crs);
  EXPECT_EQ(header->copc->centre, options.cubeCorner + 3e6);
  EXPECT_EQ(header->copc->spacing, 1000);
  const alidade::CopcHierarchy hierarchy(**file, *header);
  const auto nodes = hierarchy.nodes({});
  ASSERT_TRUE(nodes.has_value()) << nodes.error().text();
  ASSERT_EQ(nodes->size(), cells.size());
  for (const auto& node : *nodes) {
    const auto& batch = cells.at({node.cell.depth, node.cell.x, node.cell.y, node.cell.z});
    EXPECT_EQ(node.run.count, batch.size());
    for (const auto& p : batch.position) EXPECT_TRUE(node.cube.contains(p));
  }
  // A region: exactly the cells that touch it; a level: none deeper.
  alidade::CopcQuery query;
  query.region.add(points.position[17]);
  query.deepest = 2;
  const auto some = hierarchy.nodes(query);
  ASSERT_TRUE(some.has_value());
  std::size_t expected = 0;
  for (const auto& node : *nodes) expected += node.cell.depth <= 2 && node.cube.contains(points.position[17]);
  EXPECT_EQ(some->size(), expected);
  EXPECT_GT(expected, 0u);
}

TEST(CopcWriter, CellsAreNeededAndComeOnce) {
  PointBatch batch = wildPoints(10, false, true, false, false);
  ScanWriteOptions options = wildOptions();
  EXPECT_THAT(writeAll(Kind::Copc, pathFor("a.copc.laz"), options, {}), HasSubstr("no cube"));
  options.cubeSize = 1e9;
  EXPECT_THAT(writeAll(Kind::Copc, pathFor("a.copc.laz"), options, {{batch, {}}}), HasSubstr("no cell"));
  const OctreeCell root, below{1, 0, 0, 0};
  EXPECT_THAT(writeAll(Kind::Copc, pathFor("a.copc.laz"), options, {{batch, root}, {batch, below}, {batch, root}}),
              HasSubstr("comes twice"));
}

TEST(LasReading, PointsComeInAnyOrderWithTheirPlacesAndInColumnsThatAreUsedAgain) {
  const PointBatch points = wildPoints(300000, false, true, false, false);
  for (const Kind kind : {Kind::Las, Kind::Laz}) {
    const std::string path = pathFor("any-order.laz");
    ASSERT_EQ(writeAll(kind, path, wildOptions(), {{points, {}}}), "");
    std::map<std::uint64_t, PointBatch> runs;
    std::mutex mutex;
    const auto sink = [&](std::uint64_t number, PointBatch& batch) {
      std::lock_guard lock(mutex);
      runs[number] = batch;
      if (number % 3 == 0) batch.extra.clear(), batch.gpsTime = {}, batch.position.pop_back();  // whatever a sink leaves
      return true;
    };
    const auto read = LasReader().readAnyOrder(path, sink, alidade::Progress());
    ASSERT_TRUE(read.has_value()) << read.error().text();
    PointBatch all;
    for (const auto& [number, batch] : runs) alidade::testing::appendBatch(all, batch);
    expectSamePoints(all, readEverything(path).all, path);
    EXPECT_EQ(all.size(), points.size());
    std::atomic<int> calls{0};
    const auto stop = [&](std::uint64_t, PointBatch&) { return ++calls, false; };
    EXPECT_TRUE(LasReader().readAnyOrder(path, stop, alidade::Progress()).has_value());
    EXPECT_LE(calls, alidade::workerCount());
  }
}

TEST(LasReading, RecordsComeAsTheyStandWithTheirExtent) {
  PointBatch points = wildPoints(40000, false, true, false, false);
  points.row.clear(), points.column.clear(), points.scanner.clear();
  for (const Kind kind : {Kind::Las, Kind::Laz}) {
    const std::string path = pathFor("records.laz");
    ASSERT_EQ(writeAll(kind, path, wildOptions(), {{points, {}}}), "");
    const PointBatch all = readEverything(path).all;
    std::atomic<std::size_t> seen{0};
    std::mutex mutex;
    const auto sink = [&](std::uint64_t number, const alidade::PointRecords& records) {
      std::lock_guard lock(mutex);
      glm::ivec3 low(std::numeric_limits<std::int32_t>::max()), high(std::numeric_limits<std::int32_t>::min());
      for (std::size_t i = 0; i < records.count; ++i) {
        const std::byte* record = records.data + i * records.format.bytes;
        glm::ivec3 place;
        std::memcpy(&place, record, sizeof place);
        low = glm::min(low, place), high = glm::max(high, place);
        EXPECT_EQ(records.format.scale * glm::dvec3(place) + records.format.offset, all.position[number + i]);
        for (const alidade::RecordField& field : records.format.fields) {
          if (field.name == "intensity") {
            EXPECT_EQ(std::memcmp(record + field.at, &all.intensity[number + i], 2), 0);
          }
        }
      }
      EXPECT_EQ(records.low, low);
      EXPECT_EQ(records.high, high);
      seen += records.count;
      return true;
    };
    const auto read = LasReader().readRecords(path, sink, alidade::Progress());
    ASSERT_TRUE(read.has_value()) << read.error().text();
    EXPECT_TRUE(read->has_value());
    EXPECT_EQ(seen, points.size());
  }
}

TEST(LasSample, ASampleIsEvenHasEveryColumnAndAboutTheWantedSize) {
  const PointBatch points = wildPoints(300000, false, true, false, false);
  for (const Kind kind : {Kind::Las, Kind::Laz}) {
    const std::string path = pathFor("sample.laz");
    ASSERT_EQ(writeAll(kind, path, wildOptions(), {{points, {}}}), "");
    PointBatch sample;
    const auto ok = LasReader().sample(
        path, 30000, [&](PointBatch& batch) { alidade::testing::appendBatch(sample, batch); return true; }, alidade::Progress());
    ASSERT_TRUE(ok.has_value()) << ok.error().text();
    EXPECT_NEAR(static_cast<double>(sample.size()), 30000, 1500);
    EXPECT_EQ(sample.extra.size(), points.extra.size());
    // Rows of 100 points: the sample reaches every part of the file.
    std::array<int, 6> parts{};
    for (const auto column : sample.column) ++parts[column / 500];
    for (const int part : parts) EXPECT_NEAR(part, 5000, 1500);
  }
}
