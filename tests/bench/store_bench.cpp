// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// From a LAS file to a store on disk, and from a store on disk to a first picture.

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

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

/// Where sites are made: gone with the program, unless ALIDADE_BENCH_FOLDER names a place to keep them in for the next run.
struct Workplace {
  const char* kept = std::getenv("ALIDADE_BENCH_FOLDER");
  fs::path folder = kept != nullptr ? fs::path(kept) : fs::temp_directory_path() / fmt::format("alidade-bench-{}", ::getpid());
  Workplace() { fs::create_directories(folder); }
  ~Workplace() {
    std::error_code ignored;
    if (kept == nullptr) fs::remove_all(folder, ignored);
  }
};

/// A LAS file and what is made of it.
struct Site {
  std::uint32_t points;
  std::string las, store;

  Site(const fs::path& folder, std::uint32_t millions)
      : points(millions * 1'000'000), las((folder / fmt::format("site-{}M.las", millions)).string()),
        store((folder / fmt::format("site-{}M.alidade-points", millions)).string()) {
    if (!fs::exists(las)) writeLas();
  }

  /// LAS 1.2, point format 2, millimetres: the ground of test::siteOf() and its houses' walls and roofs, in strips,
  /// as a vehicle drives by.
  void writeLas() const {
    std::vector<char> header(227, 0);
    const auto put = [&](std::size_t at, auto value) { std::memcpy(header.data() + at, &value, sizeof value); };
    std::memcpy(header.data(), "LASF", 4);
    header[24] = 1, header[25] = 2;
    put(94, std::uint16_t{227}), put(96, std::uint32_t{227});
    header[104] = 2;
    put(105, std::uint16_t{26}), put(107, points), put(111, points);
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
    for (std::uint32_t i = 0; i < points; ++i) {
      double y = 200.0 * i / points, x = 200 * unit(), up = 0;
      if (std::fmod(x, 25) > 12 && std::fmod(y, 25) > 12) {
        up = i % 4 == 0 ? 8.0 : 8.0 * unit();
        if (i % 4 == 1) x += 25 - std::fmod(x, 25) - 13 * std::floor(2 * unit());
        else if (i % 4 > 1) y += 25 - std::fmod(y, 25) - 13 * std::floor(2 * unit());
      }
      const double z = 2 * std::sin(0.05 * x) + std::cos(0.08 * y) + 0.003 * unit() + up;
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
      if (records.size() > (1 << 22) || i + 1 == points) file.write(records.data(), static_cast<std::streamsize>(records.size())), records.clear();
    }
  }
};

const Site& siteOf(std::uint32_t millions) {
  static const Workplace workplace;
  static std::map<std::uint32_t, Site> made;
  return made.try_emplace(millions, workplace.folder, millions).first->second;
}

Result<IndexReport> index(const Site& site, std::uint64_t memoryBytes) {
  const LasReader reader;
  const auto info = reader.inspect(site.las);
  if (!info) return fail(info.error());
  ScanSource scan;
  scan.name = site.las;
  scan.info = *info;
  scan.read = [&](const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    if (auto read = reader.read(site.las, sink, progress); !read) return fail(read.error());
    return {};
  };
  scan.readAnyOrder = [&](const ScanSource::NumberedSink& sink, const Progress& progress) -> Result<void> {
    if (auto read = reader.readAnyOrder(site.las, sink, progress); !read) return fail(read.error());
    return {};
  };
  scan.readRecords = [&](const RecordSink& sink, const Progress& progress) -> Result<bool> {
    const auto read = reader.readRecords(site.las, sink, progress);
    if (!read) return fail(read.error());
    return read->has_value();
  };
  scan.sample = [&](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) {
    return reader.sample(site.las, wanted, sink, progress);
  };
  IndexOptions options;
  options.memoryBytes = memoryBytes;
  return indexScans(std::span(&scan, 1), site.store, options, Progress());
}

/// The site's store, made when a row first asks for it.
std::shared_ptr<const PointStore> storeOf(benchmark::State& state, std::uint32_t millions) {
  const Site& site = siteOf(millions);
  if (!isStoreFolder(site.store)) {
    if (const auto report = index(site, std::uint64_t{2} << 30); !report) return state.SkipWithError(report.error().text().c_str()), nullptr;
  }
  const auto opened = openStore(site.store);
  if (!opened) return state.SkipWithError(opened.error().text().c_str()), nullptr;
  return opened->parts[0].points;
}

void index_las(benchmark::State& state) {
  const Site& site = siteOf(20);
  const double start = test::cpuSeconds();
  for (auto _ : state) {
    state.PauseTiming();
    fs::remove_all(site.store);
    state.ResumeTiming();
    const auto report = index(site, static_cast<std::uint64_t>(state.range(0)) << 20);
    if (!report) return state.SkipWithError(report.error().text().c_str());
  }
  state.counters["cpu_ms"] = 1e3 * (test::cpuSeconds() - start) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * site.points);
}

/// Views of the site, by number.
RigidTransform viewOf(std::int64_t number) {
  if (number == 0) return test::overview();
  if (number == 1) return RigidTransform::cameraLookingAt({402006, 5655006, 117}, {402100, 5655060, 113});  // between the houses
  return RigidTransform::cameraLookingAt({402100, 5655100, 122}, {402112, 5655118, 112});                 // from a roof down
}

/// Per cent of the pixels that have no depth and drawn ones on all four sides within two pixels.
double holesOf(const DepthImage& depth) {
  const auto empty = [&](int x, int y) { return !std::isfinite(depth.at(x, y)); };
  std::uint64_t holes = 0;
  for (int y = 2; y + 2 < depth.height(); ++y)
    for (int x = 2; x + 2 < depth.width(); ++x)
      holes += empty(x, y) && !(empty(x - 1, y) && empty(x - 2, y)) && !(empty(x + 1, y) && empty(x + 2, y)) &&
               !(empty(x, y - 1) && empty(x, y - 2)) && !(empty(x, y + 1) && empty(x, y + 2));
  return 100.0 * static_cast<double>(holes) / (static_cast<double>(depth.width()) * depth.height());
}

/// Choose and draw a point for every pixel.
void frame(benchmark::State& state, std::uint32_t millions) {
  const auto store = storeOf(state, millions);
  if (!store) return;
  const Camera camera = test::hdCamera();
  const RigidTransform view = viewOf(state.range(0));
  SplatImages images = splat({{store, select(*store, camera, view, {})}}, camera, view, {.colour = true});  // pages come from disk once
  state.counters["drawn"] = static_cast<double>(images.drawn);
  state.counters["holes_pct"] = holesOf(images.depth);
  const double start = test::cpuSeconds();
  for (auto _ : state) images = splat({{store, select(*store, camera, view, {})}}, camera, view, {.colour = true});
  state.counters["cpu_ms"] = 1e3 * (test::cpuSeconds() - start) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(images.drawn));
}

void frame_10M(benchmark::State& state) {
  frame(state, 10);
}
void frame_100M(benchmark::State& state) {
  frame(state, 100);
}

void select_100M(benchmark::State& state) {
  const auto store = storeOf(state, 100);
  if (!store) return;
  const Camera camera = test::hdCamera();
  const RigidTransform view = viewOf(state.range(0));
  SelectionOptions options;
  options.density = static_cast<double>(state.range(1)) / 100.0;
  Selection selection;
  for (auto _ : state) selection = select(*store, camera, view, options);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * store->pointCount()));
  state.counters["selected"] = static_cast<double>(selection.pointCount);
  state.counters["ranges"] = static_cast<double>(selection.ranges.size());
  state.counters["nodes"] = static_cast<double>(store->nodes().size());
}

/// Open, choose a point for every pixel, draw; the files' pages are in the system's cache.
void first_picture_store(benchmark::State& state, std::uint32_t millions) {
  if (!storeOf(state, millions)) return;
  const Camera camera = test::hdCamera();
  std::uint64_t drawn = 0;
  for (auto _ : state) {
    const auto store = openStore(siteOf(millions).store);
    if (!store) return state.SkipWithError(store.error().text().c_str());
    const auto& points = store->parts[0].points;
    drawn = splat({{points, select(*points, camera, test::overview(), {})}}, camera, test::overview(), {.colour = true}).drawn;
  }
  state.counters["drawn"] = static_cast<double>(drawn);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * drawn));
}

void first_picture_store_20M(benchmark::State& state) {
  first_picture_store(state, 20);
}
void first_picture_store_100M(benchmark::State& state) {
  first_picture_store(state, 100);
}

/// From a file that nobody has looked at to a picture: a sample of its points, built in memory and drawn.
void first_picture_las_10M(benchmark::State& state) {
  constexpr std::uint64_t kSample = 1'000'000;
  const Site& site = siteOf(10);
  const Camera camera = test::hdCamera();
  const LasReader reader;
  SplatImages images;
  for (auto _ : state) {
    PointStoreBuilder builder;
    const auto take = [&](PointBatch& batch) { return builder.add(std::move(batch)), true; };
    if (const auto read = reader.sample(site.las, kSample, take, Progress()); !read) return state.SkipWithError(read.error().text().c_str());
    const auto store = builder.build(Progress());
    if (!store) return state.SkipWithError(store.error().text().c_str());
    images = splat({{*store, select(**store, camera, test::overview(), {})}}, camera, test::overview(), {.colour = true});
  }
  state.counters["drawn"] = static_cast<double>(images.drawn);
  state.counters["holes_pct"] = holesOf(images.depth);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * site.points);
}

BENCHMARK(index_las)->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(2048)->Arg(512)->Iterations(1);
BENCHMARK(first_picture_las_10M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(first_picture_store_20M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(first_picture_store_100M)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(frame_10M)->Unit(benchmark::kMillisecond)->UseRealTime()->DenseRange(0, 2)->ArgName("view");
BENCHMARK(frame_100M)->Unit(benchmark::kMillisecond)->UseRealTime()->DenseRange(0, 2)->ArgName("view");
BENCHMARK(select_100M)->Unit(benchmark::kMicrosecond)->UseRealTime()->ArgsProduct({{0, 1, 2}, {100, 50}})->ArgNames({"view", "density"});

}  // namespace
