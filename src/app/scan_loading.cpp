// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_loading.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>

#include <fmt/format.h>

#include "app/scan_source.h"
#include "cloud/store_folder.h"
#include "cloud/store_index.h"
#include "io/reader_registry.h"

namespace alidade {

namespace {

constexpr std::uint64_t kBatch = 100000;

/// Null where no scanner's grid is known.
std::shared_ptr<const OccluderMesh> surfaceOf(const PointStore& store, const std::vector<Station>& stations,
                                              const Progress& progress) {
  if (stations.empty() || !store.attribute("row") || !store.attribute("column")) return nullptr;
  OccluderMeshBuilder builder(stations);
  for (std::uint64_t first = 0; first < store.pointCount() && !progress.cancelled(); first += kBatch) {
    progress.report(static_cast<double>(first) / static_cast<double>(store.pointCount()), "Joining the scanner's grid");
    builder.add(store.batch(first, std::min(kBatch, store.pointCount() - first)));
  }
  if (progress.cancelled()) return nullptr;
  auto mesh = std::make_shared<const OccluderMesh>(builder.build());
  return mesh->packs.empty() ? nullptr : mesh;
}

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
  if (isStoreFolder(path))
    if (auto kept = openStore(path); kept && !kept->parts.empty() && kept->parts.front().manifest.identity == source.identity)
      return kept;
  if (auto made = indexScans(std::span(&source, 1), path, {}, progress); !made) return fail(made.error());
  return openStore(path);
}

Result<std::shared_ptr<const PointStore>> readStore(const Scan& scan, std::vector<ImportWarning>& warnings,
                                                    const Progress& progress) {
  const auto reader = ReaderRegistry::instance().findAs<ScanReader>(scan.source.path);
  if (!reader) return fail(reader.error());
  PointStoreBuilder::Options options;
  options.scale = scan.info.scale;
  options.offset = scan.info.offset;
  PointStoreBuilder builder(options);
  auto read = (*reader)->read(
      scan.source.path,
      [&](PointBatch& batch) {
        builder.add(std::move(batch));
        return !progress.cancelled();
      },
      progress.part(0.0, 0.5));
  if (!read) return fail(read.error());
  if (progress.cancelled()) return fail(cancelledError());
  warnings.insert(warnings.end(), read->begin(), read->end());
  if (builder.droppedCount() > 0)
    warnings.push_back({fmt::format("{} points without finite coordinates were left out", builder.droppedCount()),
                        scan.source.path});
  return builder.build(progress.part(0.5, 1.0));
}

/// Joining a larger store's grids would read all of it before the first picture.
std::vector<ScanLayer> layersOf(const StoreFolder& store, int number, const Progress& progress) {
  std::vector<ScanLayer> layers;
  for (const StorePart& part : store.parts) {
    ScanLayer layer;
    layer.points = {part.points, std::make_shared<const PointSummary>(summarise(*part.points)), number};
    if (part.points->pointCount() < kIndexedPoints)
      layer.surface = surfaceOf(*part.points, part.manifest.info.stations, progress);
    layers.push_back(std::move(layer));
  }
  return layers;
}

}  // namespace

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
  layer.surface = surfaceOf(**store, scan.info.stations, progress.part(0.8, 1.0));
  if (progress.cancelled()) return fail(cancelledError());
  return std::vector<ScanLayer>{std::move(layer)};
}

}  // namespace alidade
