// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <sys/stat.h>

#include <atomic>
#include <cstring>
#include <limits>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cloud/byte_pack.h"
#include "cloud/store_data.h"
#include "unit/cloud/store_sources.h"

namespace alidade {
namespace {

namespace fs = std::filesystem;
using test::difference;
using test::hallScan;

constexpr std::uint64_t kPoints = 300'000;
constexpr std::uint64_t kLittleMemory = 8 << 20;

IndexOptions optionsOf(std::uint64_t memory = std::uint64_t{1} << 30) {
  IndexOptions options;
  options.memoryBytes = memory;
  options.threads = 2;
  return options;
}

IndexOptions appending() {
  IndexOptions options = optionsOf();
  options.append = true;
  return options;
}

Result<IndexReport> index(const ScanSource& scan, const std::string& path, const IndexOptions& options) {
  return indexScans(std::span(&scan, 1), path, options, Progress());
}

TEST(StoreFolder, HoldsTheSameAsAStoreInMemory) {
  const test::ScratchFolder scratch;
  for (const LevelKind levels : {LevelKind::BlueNoise, LevelKind::Random}) {
    const ScanSource scan = hallScan(kPoints);
    const auto memory = test::inMemory(scan, levels);
    for (const std::uint64_t bytes : {std::uint64_t{1} << 30, kLittleMemory}) {
      IndexOptions options = optionsOf(bytes);
      options.levels = levels;
      const std::string path = scratch / fmt::format("{}-{}.alidade-points", static_cast<int>(levels), bytes);
      const auto report = index(scan, path, options);
      ASSERT_TRUE(report) << report.error().text();
      EXPECT_EQ(report->points, kPoints);
      EXPECT_EQ(report->dropped, 0u);
      const auto store = openStore(path);
      ASSERT_TRUE(store) << store.error().text();
      ASSERT_EQ(store->parts.size(), 1u);
      EXPECT_EQ(difference(*memory, *store->parts[0].points), "");
      // Nothing of the work is left.
      for (const auto& [name, content] : test::filesOf(path)) EXPECT_FALSE(name.ends_with(".tmp")) << name;
    }
  }
}

TEST(StoreFolder, IsTheSameWhateverTheOrderThatThreadsReadIn) {
  const test::ScratchFolder scratch;
  ScanSource scan = hallScan(kPoints);
  const auto memory = test::inMemory(scan);
  // Runs of any size, the last first, on more threads than work on them.
  scan.readAnyOrder = [](const ScanSource::NumberedSink& sink, const Progress&) -> Result<void> {
    std::atomic<std::int64_t> left{kPoints};
    std::vector<std::thread> threads;
    for (int t = 0; t < 5; ++t)
      threads.emplace_back([&, count = 7001 + 500 * t] {
        for (std::int64_t end = left.fetch_sub(count); end > 0; end = left.fetch_sub(count)) {
          const auto first = static_cast<std::uint64_t>(std::max<std::int64_t>(0, end - count));
          PointBatch batch = test::hallPoints(first, static_cast<std::uint64_t>(end) - first, 1);
          if (!sink(first, batch)) return;
        }
      });
    for (std::thread& thread : threads) thread.join();
    return {};
  };
  ASSERT_TRUE(index(scan, scratch / "any.alidade-points", optionsOf()));
  const auto store = openStore(scratch / "any.alidade-points");
  ASSERT_TRUE(store) << store.error().text();
  EXPECT_EQ(difference(*memory, *store->parts[0].points), "");
}

/// A scan whose batches and records hold the same, in a format made up here: numbers that cross words, a byte shared by
/// two fields, one put together of two bytes, and points that no survey has.
class RecordScan {
 public:
  static constexpr std::size_t kBytes = 36;

  explicit RecordScan(std::uint16_t rgbWhite) {
    m_format.bytes = kBytes;
    m_format.scale = glm::dvec3(0.1), m_format.offset = {400000, 5500000, 100};
    m_format.rgbWhite = rgbWhite;
    RecordField::Part low{14, {}}, high{14, {}}, ends{35, {}};
    for (unsigned v = 0; v < 256; ++v) {
      low.values[v] = v & 7, high.values[v] = v >> 3 & 7;
      ends.values[v] = static_cast<std::uint8_t>(v << 4);
    }
    m_format.fields = {{"rgb", NumberType::U16, 3, false, 15, {}},          {"intensity", NumberType::U16, 1, false, 12, {}},
                       {"return_number", NumberType::U8, 1, false, 0, {low}}, {"return_count", NumberType::U8, 1, false, 0, {high}},
                       {"gps_time", NumberType::F64, 1, false, 21, {}},       {"flags", NumberType::U8, 1, true, 0, {low, ends}},
                       {"wave", NumberType::U8, 5, true, 29, {}},             {"angle", NumberType::I8, 1, true, 34, {}}};
  }

  ScanSource source(bool asRecords) const {
    ScanSource scan = hallScan(kPoints);
    scan.info.scale = m_format.scale, scan.info.offset = m_format.offset;
    scan.info.bounds = {};
    scan.read = [this](const ScanSource::Sink& sink, const Progress&) -> Result<void> {
      for (std::uint64_t first = 0; first < kPoints; first += kRun) {
        PointBatch batch = columns(first, std::min(kRun, kPoints - first));
        if (!sink(batch)) break;
      }
      return {};
    };
    scan.sample = nullptr;
    if (!asRecords) return scan;
    scan.readRecords = [this](const RecordSink& sink, const Progress&) -> Result<bool> {
      for (std::uint64_t first = 0; first < kPoints; first += kRun) {
        const std::uint64_t count = std::min(kRun, kPoints - first);
        std::vector<std::byte> bytes(count * kBytes);
        glm::ivec3 low(std::numeric_limits<std::int32_t>::max()), high(std::numeric_limits<std::int32_t>::min());
        for (std::uint64_t i = 0; i < count; ++i) {
          write(first + i, bytes.data() + i * kBytes);
          low = glm::min(low, placeOf(first + i)), high = glm::max(high, placeOf(first + i));
        }
        if (!sink(first, {m_format, bytes.data(), count, low, high})) break;
      }
      return true;
    };
    return scan;
  }

 private:
  static constexpr std::uint64_t kRun = 30'000;

  static std::uint64_t drawn(std::uint64_t i) {
    std::uint64_t h = (i + 1) * 0x9e3779b97f4a7c15ull;
    h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
    return h ^ h >> 27;
  }
  static glm::ivec3 placeOf(std::uint64_t i) {
    const std::uint64_t h = drawn(i);
    if (i % 70'001 == 5) return {2'000'000'000, 0, 0};  // 2e8 m away
    return {h % 90'000 - 45'000, h >> 20 & 0xffff, h >> 40 & 0xff};
  }
  std::uint16_t colourOf(std::uint64_t i, unsigned channel) const {
    return static_cast<std::uint16_t>((i * (channel + 3)) % (m_format.rgbWhite + 1u));
  }

  void write(std::uint64_t i, std::byte* record) const {
    const auto put = [&](std::size_t at, auto value) { std::memcpy(record + at, &value, sizeof value); };
    put(0, placeOf(i));
    put(12, static_cast<std::uint16_t>(i * 7));
    put(14, static_cast<std::uint8_t>(i % 61));
    for (unsigned c = 0; c < 3; ++c) put(15 + 2 * c, colourOf(i, c));
    put(21, 3e8 + 1e-5 * static_cast<double>(i));
    for (unsigned b = 0; b < 5; ++b) put(29 + b, static_cast<std::uint8_t>(i >> b));
    put(34, static_cast<std::int8_t>(i % 180 - 90)), put(35, static_cast<std::uint8_t>(i % 3));
  }

  PointBatch columns(std::uint64_t first, std::uint64_t count) const {
    PointBatch batch;
    batch.rgbWhite = m_format.rgbWhite;
    batch.extra = {{"flags", NumberType::U8, 1, {}}, {"wave", NumberType::U8, 5, {}}, {"angle", NumberType::I8, 1, {}}};
    for (std::uint64_t i = first; i < first + count; ++i) {
      batch.position.push_back(m_format.scale * glm::dvec3(placeOf(i)) + m_format.offset);
      batch.rgb.emplace_back(colourOf(i, 0), colourOf(i, 1), colourOf(i, 2));
      batch.intensity.push_back(static_cast<std::uint16_t>(i * 7));
      batch.returnNumber.push_back(i % 61 & 7), batch.returnCount.push_back(i % 61 >> 3);
      batch.gpsTime.push_back(3e8 + 1e-5 * static_cast<double>(i));
      batch.extra[0].data.push_back(static_cast<std::byte>((i % 61 & 7) | (i % 3) << 4));
      for (unsigned b = 0; b < 5; ++b) batch.extra[1].data.push_back(static_cast<std::byte>(i >> b));
      batch.extra[2].data.push_back(static_cast<std::byte>(i % 180 - 90));
    }
    return batch;
  }

  RecordFormat m_format;
};

TEST(StoreFolder, IsTheSameFromRecordsAsFromColumns) {
  const test::ScratchFolder scratch;
  for (const std::uint16_t white : {255, 65535}) {
    const RecordScan scan(white);
    std::vector<StoreFolder> stores;
    for (const bool asRecords : {false, true}) {
      const std::string path = scratch / fmt::format("{}-{}.alidade-points", white, asRecords);
      const auto report = index(scan.source(asRecords), path, optionsOf());
      ASSERT_TRUE(report) << report.error().text();
      EXPECT_EQ(report->dropped, 5u);
      auto store = openStore(path);
      ASSERT_TRUE(store) << store.error().text();
      stores.push_back(std::move(*store));
    }
    EXPECT_EQ(stores[0].parts[0].manifest.lattice.exact, ExactCoordinates::Lattice);
    EXPECT_EQ(difference(*stores[0].parts[0].points, *stores[1].parts[0].points), "");
  }
}

TEST(StoreFolder, KeepsWhatTheScanSaysOfItself) {
  const test::ScratchFolder scratch;
  ScanSource scan = hallScan(2000);
  scan.info.details = "Gr\xfc\xdf";  // no UTF-8
  scan.info.attributes = {"rgb", "gps_time"};
  const std::string path = scratch / "one.alidade-points";
  ASSERT_TRUE(index(scan, path, optionsOf()));
  const auto store = openStore(path);
  ASSERT_TRUE(store) << store.error().text();
  const ScanInfo& info = store->parts[0].points->info();
  EXPECT_EQ(info.pointCount, 2000u);
  EXPECT_EQ(info.details, scan.info.details);
  EXPECT_EQ(info.attributes, scan.info.attributes);
  EXPECT_EQ(info.crs, "EPSG:25832");
  EXPECT_EQ(info.scale, scan.info.scale);
  EXPECT_EQ(info.offset, scan.info.offset);
  EXPECT_EQ(info.bounds.max, scan.info.bounds.max);
  ASSERT_EQ(info.stations.size(), 1u);
  EXPECT_EQ(info.stations[0].name, "S1");
  EXPECT_EQ(info.stations[0].worldFromScanner.translation, glm::dvec3(405010, 5505010, 5101.5));
  EXPECT_EQ(info.stations[0].columns, 20u);
  EXPECT_TRUE(isStoreFolder(path));
  EXPECT_FALSE(isStoreFolder(scratch / ""));
}

/// Position and columns of a point, as one sortable text.
std::vector<std::string> multiset(const PointBatch& batch) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    std::string one(reinterpret_cast<const char*>(&batch.position[i]), sizeof batch.position[i]);
    one.append(reinterpret_cast<const char*>(&batch.rgb[i]), sizeof batch.rgb[i]);
    one.append(reinterpret_cast<const char*>(&batch.intensity[i]), sizeof batch.intensity[i]);
    one.append(reinterpret_cast<const char*>(&batch.gpsTime[i]), sizeof batch.gpsTime[i]);
    one.append(reinterpret_cast<const char*>(&batch.extra[0].data[4 * i]), 4);
    all.push_back(one);
  }
  std::ranges::sort(all);
  return all;
}

TEST(StoreFolder, GivesBackEveryPointBitForBit) {
  const test::ScratchFolder scratch;
  const ScanSource scan = hallScan(kPoints);
  const std::string path = scratch / "one.alidade-points";
  ASSERT_TRUE(index(scan, path, optionsOf(kLittleMemory)));
  const auto store = openStore(path);
  ASSERT_TRUE(store) << store.error().text();
  const PointStore& points = *store->parts[0].points;
  EXPECT_EQ(multiset(points.batch(0, points.pointCount())), multiset(test::hallPoints(0, kPoints, 1)));
}

TEST(StoreFolder, AppendsWithoutTouchingOtherParts) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "site.alidade-points", both = scratch / "both.alidade-points";
  ASSERT_TRUE(index(hallScan(20'000, 1), path, optionsOf()));
  const auto before = test::filesOf(path + "/part-0001");
  const auto time = fs::last_write_time(path + "/part-0001/points.bin");
  EXPECT_FALSE(index(hallScan(30'000, 2), path, optionsOf()));  // it exists already
  const auto report = index(hallScan(30'000, 2), path, appending());
  ASSERT_TRUE(report) << report.error().text();
  EXPECT_EQ(report->parts, 2u);
  EXPECT_EQ(test::filesOf(path + "/part-0001"), before);
  EXPECT_EQ(fs::last_write_time(path + "/part-0001/points.bin"), time);
  const std::vector<ScanSource> scans{hallScan(20'000, 1), hallScan(30'000, 2)};
  ASSERT_TRUE(indexScans(scans, both, optionsOf(), Progress()));
  EXPECT_EQ(test::filesOf(path), test::filesOf(both));
  const auto store = openStore(path);
  ASSERT_TRUE(store) << store.error().text();
  EXPECT_EQ(store->parts[1].points->pointCount(), 30'000u);
}

TEST(StoreFolder, AnEmptyScanIsAPartWithoutPoints) {
  const test::ScratchFolder scratch;
  ASSERT_TRUE(index(hallScan(0), scratch / "none.alidade-points", optionsOf()));
  const auto store = openStore(scratch / "none.alidade-points");
  ASSERT_TRUE(store) << store.error().text();
  EXPECT_EQ(store->parts[0].points->pointCount(), 0u);
}

TEST(StoreFolder, SaysWhyItCannotBeWritten) {
  const test::ScratchFolder scratch;
  const auto refusal = [&](const std::string& path, const IndexOptions& options) {
    const auto report = index(hallScan(1000), path, options);
    return report ? std::string("indexed") : report.error().what;
  };
  EXPECT_EQ(refusal(scratch / "none/one.alidade-points", optionsOf()), "The folder does not exist");
  std::ofstream(scratch / "file") << "text";
  EXPECT_EQ(refusal(scratch / "file", optionsOf()), "This is a file, not a point store");
  fs::create_directory(scratch / "pictures");
  std::ofstream(scratch / "pictures/a.jpg") << "text";
  EXPECT_EQ(refusal(scratch / "pictures", optionsOf()), "The folder exists and is no point store");
  EXPECT_EQ(refusal(scratch / "nothing", appending()), "There is no point store to append to");
  EXPECT_TRUE(fs::exists(scratch / "pictures/a.jpg"));
  if (::geteuid() != 0) {  // root may write anywhere
    ::mkdir((scratch / "locked").c_str(), 0500);
    EXPECT_TRUE(refusal(scratch / "locked/one.alidade-points", optionsOf()).starts_with("The point store may not be written here"));
  }
  EXPECT_EQ(openStore(scratch / "nothing").error().what, "There is no point store here");
  fs::create_directory(scratch / "half.alidade-points");
  EXPECT_TRUE(openStore(scratch / "half.alidade-points").error().what.starts_with("The point store is not finished"));
}

TEST(StoreFolder, CancelledLeavesNothingToOpenAndGoesOn) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points", whole = scratch / "whole.alidade-points";
  const std::vector<ScanSource> scans{hallScan(60'000, 1), hallScan(kPoints, 2)};
  Progress* listening = nullptr;
  Progress watched([&](double fraction, std::string_view) {
    if (fraction > 0.75) listening->cancel();
  });
  listening = &watched;
  const auto report = indexScans(scans, path, optionsOf(kLittleMemory), watched);
  ASSERT_FALSE(report);
  EXPECT_TRUE(isCancelled(report.error())) << report.error().text();
  EXPECT_FALSE(openStore(path));
  const auto again = indexScans(scans, path, optionsOf(kLittleMemory), Progress());
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(again->kept, 1u);  // the first scan was done
  ASSERT_TRUE(indexScans(scans, whole, optionsOf(), Progress()));
  EXPECT_EQ(test::filesOf(path), test::filesOf(whole));
}

/// A damaged copy opens with an error, or shows the same tree; and whoever reads all of it survives.
void expectErrorOrWhole(const std::string& path, const PointStore& whole, const std::string& what) {
  const auto store = openStore(path);
  if (!store) {
    EXPECT_FALSE(store.error().what.empty());
    return;
  }
  ASSERT_EQ(store->parts.size(), 1u) << what;
  const PointStore& points = *store->parts[0].points;
  ASSERT_EQ(points.pointCount(), whole.pointCount()) << what;
  const PointBatch batch = points.batch(0, points.pointCount());
  EXPECT_EQ(batch.size(), points.pointCount());
  for (std::uint32_t n = 0; n < points.nodes().size(); ++n) {
    EXPECT_TRUE(std::ranges::equal(points.levelsOf(n).cumulative, whole.levelsOf(n).cumulative)) << what;
    EXPECT_EQ(points.nodes()[n].count, whole.nodes()[n].count) << what;
  }
}

TEST(StoreFolder, DamageIsAnErrorOrNoDamage) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points";
  ASSERT_TRUE(index(hallScan(20'000), path, optionsOf()));
  const auto opened = openStore(path);
  ASSERT_TRUE(opened) << opened.error().text();
  const PointStore& whole = *opened->parts[0].points;
  const test::ScratchFolder copies;
  std::mt19937 random(3);
  for (const auto& [name, content] : test::filesOf(path)) {
    if (name == "part-0001/part.json") continue;  // only work that goes on reads it
    for (int round = 0; round < 40; ++round) {
      const std::string copy = copies / "copy.alidade-points";
      fs::remove_all(copy);
      fs::copy(path, copy, fs::copy_options::recursive);
      std::string bytes = content;
      const bool isCut = round % 4 == 0 || bytes.empty();
      if (isCut) bytes.resize(bytes.empty() ? 1 : random() % bytes.size());
      else bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
      std::ofstream(copy + "/" + name, std::ios::binary) << bytes;
      expectErrorOrWhole(copy, whole, fmt::format("{} {}", name, round));
      if (isCut) {
        EXPECT_FALSE(openStore(copy)) << name;
      }
    }
    fs::remove(fs::path(path) / name);
    EXPECT_FALSE(openStore(path)) << name << " is gone";
    std::ofstream(path + "/" + name, std::ios::binary) << content;
  }
}

TEST(StoreFolder, NodesThatDoNotFitAreRefusedEvenWithTheirChecksum) {
  const test::ScratchFolder scratch;
  const std::string path = scratch / "one.alidade-points", nodesPath = path + "/part-0001/nodes.bin";
  ASSERT_TRUE(index(hallScan(20'000), path, optionsOf()));
  const auto opened = openStore(path);
  ASSERT_TRUE(opened) << opened.error().text();
  const std::string good = test::bytesOf(nodesPath);
  std::mt19937 random(11);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::string bad = good;
    bad[random() % bad.size()] = static_cast<char>(random());
    std::ofstream(nodesPath, std::ios::binary) << bad;
    PartManifest manifest = opened->parts[0].manifest;
    manifest.nodesChecksum = checksumOf(std::as_bytes(std::span(bad)));
    const auto part = openPart(path + "/part-0001", manifest);
    refused += !part;
    if (part) {
      EXPECT_EQ(part->points->batch(0, 20'000).size(), 20'000u);
    }
  }
  EXPECT_GT(refused, 60);
  std::ofstream(nodesPath, std::ios::binary) << good;
}

/// A folder in one piece, as tests/fuzz/store_fuzz.cpp takes it, laid out again.
void layOut(const std::string& seed, const std::string& folder) {
  fs::create_directories(folder + "/part-0001");
  for (std::size_t at = 0; at + 5 <= seed.size();) {
    const int file = seed[at];
    std::uint32_t bytes;
    std::memcpy(&bytes, seed.data() + at + 1, sizeof bytes);
    constexpr const char* kFirst[] = {"manifest.json", "part-0001/nodes.bin", "part-0001/tables.bin", "part-0001/points.bin", "part-0001/exact.bin"};
    const std::string name = file < 5 ? kFirst[file] : fmt::format("part-0001/column-{:03}.bin", file - 4);
    std::ofstream(folder + "/" + name, std::ios::binary) << seed.substr(at + 5, bytes);
    at += 5 + bytes;
  }
}

TEST(StoreFolder, WhatIsFuzzedBeginsAsStoresThatOpen) {
  const test::ScratchFolder scratch;
  int seeds = 0;
  for (const auto& entry : fs::directory_iterator(ALIDADE_FUZZ_CORPUS_DIR "/store")) {
    const std::string folder = scratch / entry.path().filename().string();
    layOut(test::bytesOf(entry.path().string()), folder);
    const auto store = openStore(folder);
    ASSERT_TRUE(store) << store.error().text();
    EXPECT_EQ(store->parts[0].points->batch(0, 1000).size(), store->parts[0].points->pointCount());
    ++seeds;
  }
  EXPECT_GE(seeds, 2);
}

}  // namespace
}  // namespace alidade
