// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// From a LAS file to a store on disk, and from a store on disk to a first picture.

#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "bench/site.h"
#include "cloud/selection.h"
#include "cloud/store_folder.h"
#include "cloud/store_index.h"
#include "las/las_reader.h"
#include "raster/splatter.h"

namespace {

using namespace alidade;
namespace fs = std::filesystem;

constexpr std::uint32_t kPoints = 20'000'000;

/// A LAS file and what is made of it; gone with the program.
struct Site {
  fs::path folder = fs::temp_directory_path() / fmt::format("alidade-bench-{}", ::getpid());
  std::string las = (folder / "site.las").string(), store = (folder / "site.alidade-points").string();

  Site() {
    fs::create_directories(folder);
    writeLas();
  }
  ~Site() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }

  /// LAS 1.2, point format 2, millimetres: the site of siteOf() in strips, as a vehicle drives by.
  void writeLas() const {
    std::vector<char> header(227, 0);
    const auto put = [&](std::size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof value); };
    std::memcpy(header.data(), "LASF", 4);
    header[24] = 1, header[25] = 2;
    put(94, std::uint16_t{227}), put(96, std::uint32_t{227});
    header[104] = 2;
    put(105, std::uint16_t{26}), put(107, kPoints), put(111, kPoints);
    const double low[3] = {402000, 5655000, 105}, high[3] = {402200, 5655200, 130};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(131 + 8 * axis, 0.001), put(155 + 8 * axis, low[axis]);
      put(179 + 16 * axis, high[axis]), put(187 + 16 * axis, low[axis]);
    }
    std::ofstream file(las, std::ios::binary);
    file.write(header.data(), static_cast<std::streamsize>(header.size()));
    std::uint64_t state = 42;
    const auto unit = [&state] {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      return static_cast<double>(state >> 11) * 0x1p-53;
    };
    std::vector<char> records;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      const double y = 200.0 * i / kPoints, x = 200 * unit();
      double z = 2 * std::sin(0.05 * x) + std::cos(0.08 * y) + 0.003 * unit();
      if (std::fmod(x, 25) > 12 && std::fmod(y, 25) > 12) z += i % 4 == 0 ? 8.0 : 8.0 * unit();
      char record[26] = {};
      const std::int32_t place[3] = {static_cast<std::int32_t>(x * 1000), static_cast<std::int32_t>(y * 1000),
                                     static_cast<std::int32_t>((z + 7) * 1000)};
      const std::uint16_t rest[4] = {static_cast<std::uint16_t>(i), 0, 0, 0};
      std::memcpy(record, place, sizeof place);
      std::memcpy(record + 12, rest, 2);
      record[14] = 0x09;
      const auto shade = static_cast<std::uint16_t>(257 * static_cast<unsigned>(40 + 200 * unit()));
      for (std::size_t c = 0; c < 3; ++c) std::memcpy(record + 20 + 2 * c, &shade, 2);
      records.insert(records.end(), record, record + sizeof record);
      if (records.size() > (1 << 22) || i + 1 == kPoints) file.write(records.data(), static_cast<std::streamsize>(records.size())), records.clear();
    }
  }
};

const Site& site() {
  static const Site made;
  return made;
}

void index_las(benchmark::State& state) {
  const LasReader reader;
  const auto info = reader.inspect(site().las);
  if (!info) return state.SkipWithError(info.error().text().c_str());
  ScanSource scan;
  scan.name = site().las;
  scan.info = *info;
  scan.read = [&](const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    if (auto read = reader.read(site().las, sink, progress); !read) return fail(read.error());
    return {};
  };
  scan.sample = [&](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) {
    return reader.sample(site().las, wanted, sink, progress);
  };
  IndexOptions options;
  options.memoryBytes = static_cast<std::uint64_t>(state.range(0)) << 20;
  const double start = test::cpuSeconds();
  for (auto _ : state) {
    state.PauseTiming();
    fs::remove_all(site().store);
    state.ResumeTiming();
    const auto report = indexScans(std::span(&scan, 1), site().store, options, Progress());
    if (!report) return state.SkipWithError(report.error().text().c_str());
  }
  state.counters["cpu_ms"] = 1e3 * (test::cpuSeconds() - start) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * kPoints);
}

/// Open, choose a point for every pixel, draw; the files' pages are in the system's cache. After index_las.
void first_picture_store_20M(benchmark::State& state) {
  if (!isStoreFolder(site().store)) return state.SkipWithError("run index_las as well");
  const Camera camera = test::hdCamera();
  std::uint64_t drawn = 0;
  for (auto _ : state) {
    const auto store = openStore(site().store);
    if (!store) return state.SkipWithError(store.error().text().c_str());
    const auto& points = store->parts[0].points;
    drawn = splat({{points, select(*points, camera, test::overview(), {})}}, camera, test::overview(), {.colour = true}).drawn;
  }
  state.counters["drawn"] = static_cast<double>(drawn);
}

BENCHMARK(index_las)->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(2048)->Arg(512)->Iterations(1);
BENCHMARK(first_picture_store_20M)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
