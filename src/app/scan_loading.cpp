// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_loading.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <span>

#include <fmt/format.h>

#include "app/scan_source.h"
#include "app/scan_surface.h"
#include "cloud/store_folder.h"
#include "cloud/store_index.h"
#include "io/reader_registry.h"

namespace alidade {

namespace {

/// From this many points on a scan is indexed on disk rather than built in memory.
constexpr std::uint64_t kIndexedPoints = 20'000'000;

/// Where a scan's store is kept between sessions: below ALIDADE_CACHE, else the user's cache folder (XDG Base
/// Directory Specification). Empty where there is none, or where the scan's state cannot be told.
std::string keptStorePath(const std::string& identity) {
  if (identity.empty()) return {};
  std::filesystem::path folder;
  if (const char* wanted = std::getenv("ALIDADE_CACHE")) folder = wanted;
  else if (const char* cache = std::getenv("XDG_CACHE_HOME")) folder = std::filesystem::path(cache) / "alidade";
  else if (const char* home = std::getenv("HOME")) folder = std::filesystem::path(home) / ".cache/alidade";
  if (folder.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(folder / "points", error);
  if (error) return {};
  // FNV-1a of 64 bits: the name only has to tell a user's scans apart; indexScans compares the identity itself.
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : identity) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return (folder / "points" / fmt::format("{:016x}.alidade-points", hash)).string();
}

/// Opens the scan's kept store, or makes it: what is larger than memory is drawn from disk.
Result<StoreFolder> keptStore(const ScanSource& source, const Progress& progress) {
  const std::string path = keptStorePath(source.identity);
  if (path.empty()) return fail("There is no folder to keep the scan's index in", {}, "Set ALIDADE_CACHE to a folder");
  if (isStoreFolder(path)) {
    if (auto kept = openStore(path); kept && !kept->parts.empty() && kept->parts.front().manifest.identity == source.identity)
      return kept;
    // Finished, but damaged or of another version of the program: it is ours, and made anew. Unfinished work has no manifest and goes on.
    std::error_code error;
    std::filesystem::remove(std::filesystem::path(path) / kManifestName, error);
  }
  if (auto made = indexScans(std::span(&source, 1), path, {}, progress); !made) return fail(made.error());
  return openStore(path);
}

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// "Reading hall.las: 3.1 of 10.0 M points, 4.2 Mpts/s".
std::string readingText(const Scan& scan, std::uint64_t points, double seconds) {
  std::string text = fmt::format("Reading {}", std::filesystem::path(scan.source.path).filename().string());
  if (seconds > 0.5)
    text += fmt::format(": {:.1f} of {:.1f} M points, {:.1f} Mpts/s", static_cast<double>(points) / 1e6,
                        static_cast<double>(scan.info.pointCount) / 1e6, static_cast<double>(points) / seconds / 1e6);
  return text;
}

Result<std::shared_ptr<const PointStore>> readStore(const Scan& scan, std::vector<ImportWarning>& warnings,
                                                    const Progress& progress) {
  const auto reader = ReaderRegistry::instance().findAs<ScanReader>(scan.source.path);
  if (!reader) return fail(reader.error());
  const auto start = std::chrono::steady_clock::now();
  std::uint64_t points = 0;
  const Progress outer = progress.part(0.0, 0.5);
  const Progress reading([&](double fraction, std::string_view) { outer.report(fraction, readingText(scan, points, secondsSince(start))); });
  PointStoreBuilder::Options options;
  options.scale = scan.info.scale;
  options.offset = scan.info.offset;
  PointStoreBuilder builder(options);
  auto read = (*reader)->read(
      scan.source.path,
      [&](PointBatch& batch) {
        points += batch.size();
        builder.add(std::move(batch));
        return !progress.cancelled();
      },
      reading);
  if (!read) return fail(read.error());
  if (progress.cancelled()) return fail(cancelledError());
  warnings.insert(warnings.end(), read->begin(), read->end());
  if (builder.droppedCount() > 0)
    warnings.push_back({fmt::format("{} points without finite coordinates were left out", builder.droppedCount()),
                        scan.source.path});
  return builder.build(progress.part(0.5, 1.0));
}

std::vector<ScanLayer> layersOf(const StoreFolder& store, int number, const Progress& progress) {
  std::vector<ScanLayer> layers;
  for (const StorePart& part : store.parts) {
    ScanLayer layer;
    layer.points = {part.points, std::make_shared<const PointSummary>(summarise(*part.points)), number};
    layer.surface = surfaceOfPart(store.path, part, progress);
    layers.push_back(std::move(layer));
  }
  return layers;
}

}  // namespace

Result<std::vector<ScanLayer>> sampleScan(const Scan& scan, int number, const Progress& progress) {
  constexpr std::uint64_t kLarge = 2'000'000, kSample = 400'000;
  constexpr double kMostSeconds = 1.0;
  if (scan.info.pointCount < kLarge || isStoreFolder(scan.source.path)) return std::vector<ScanLayer>{};
  const auto reader = ReaderRegistry::instance().findAs<ScanReader>(scan.source.path);
  if (!reader) return fail(reader.error());
  // A store that is kept from an earlier session opens sooner.
  const std::string identity = scanSourceOf(**reader, scan.source.path, scan.info, nullptr).identity;
  if (scan.info.pointCount >= kIndexedPoints && isStoreFolder(keptStorePath(identity))) return std::vector<ScanLayer>{};
  PointStoreBuilder::Options options;
  options.scale = scan.info.scale;
  options.offset = scan.info.offset;
  PointStoreBuilder builder(options);
  const auto start = std::chrono::steady_clock::now();
  auto sampled = (*reader)->sample(
      scan.source.path, kSample,
      [&](PointBatch& batch) {
        builder.add(std::move(batch));
        return !progress.cancelled() && secondsSince(start) < kMostSeconds;
      },
      Progress());
  if (!sampled) return fail(sampled.error());
  if (progress.cancelled()) return fail(cancelledError());
  const auto store = builder.build(progress);
  if (!store) return fail(store.error());
  if ((*store)->pointCount() == 0) return std::vector<ScanLayer>{};
  ScanLayer layer;
  layer.points = {*store, std::make_shared<const PointSummary>(summarise(**store)), number};
  layer.sampleOf = scan.info.pointCount;
  return std::vector<ScanLayer>{std::move(layer)};
}

Result<std::vector<ScanLayer>> loadScan(const Scan& scan, int number, std::vector<ImportWarning>& warnings,
                                        const Progress& progress) {
  if (isStoreFolder(scan.source.path)) {
    const auto store = openStore(scan.source.path);
    if (!store) return fail(store.error());
    return layersOf(*store, number, progress);
  }
  if (scan.info.pointCount >= kIndexedPoints) {
    const auto reader = ReaderRegistry::instance().findAs<ScanReader>(scan.source.path);
    if (!reader) return fail(reader.error());
    const auto info = (*reader)->inspect(scan.source.path);
    if (!info) return fail(info.error());
    const auto store = keptStore(scanSourceOf(**reader, scan.source.path, *info, &warnings), progress);
    if (!store) return fail(store.error());
    return layersOf(*store, number, progress);
  }
  auto store = readStore(scan, warnings, progress.part(0.0, 0.8));
  if (!store) return fail(store.error());
  ScanLayer layer;
  layer.points = {*store, std::make_shared<const PointSummary>(summarise(**store)), number};
  layer.surface = joinGrids(**store, scan.info.stations, progress.part(0.8, 1.0));
  if (progress.cancelled()) return fail(cancelledError());
  return std::vector<ScanLayer>{std::move(layer)};
}

}  // namespace alidade
