// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_source.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/scan_join.h"
#include "cloud/store_folder.h"
#include "io/reader_registry.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

/// Empty where the file's state cannot be told (a web address): such work never goes on after a kill.
std::string identityOf(const std::string& path, const std::string& reader) {
  std::error_code error;
  const fs::path whole = fs::canonical(path, error);
  if (error || !fs::is_regular_file(whole, error)) return {};
  const auto size = fs::file_size(whole, error);
  if (error) return {};
  const auto time = fs::last_write_time(whole, error);
  if (error) return {};
  return fmt::format("{}|{}|{}|{}", reader, whole.string(), size, time.time_since_epoch().count());
}

void addOnce(const std::vector<ImportWarning>& found, std::vector<ImportWarning>& all) {
  for (const ImportWarning& warning : found) {
    const auto same = [&](const ImportWarning& other) { return other.what == warning.what && other.where == warning.where; };
    if (std::ranges::none_of(all, same)) all.push_back(warning);
  }
}

constexpr std::uint64_t kBatch = 100'000;

/// A part of a store as a scan, in the store's order.
ScanSource scanSourceOf(const StorePart& part, const std::string& path) {
  ScanSource source;
  source.name = path;
  source.identity = part.manifest.identity;
  source.info = part.manifest.info;
  source.notes = part.manifest.notes;
  source.info.pointCount = part.points->pointCount();
  source.info.bounds = part.points->bounds();
  source.read = [points = part.points](const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    for (std::uint64_t first = 0; first < points->pointCount(); first += kBatch) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(static_cast<double>(first) / static_cast<double>(points->pointCount()), "Reading the point store");
      PointBatch batch = points->batch(first, std::min(kBatch, points->pointCount() - first));
      if (!sink(batch)) return {};
    }
    return {};
  };
  source.sample = [points = part.points](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    const auto all = static_cast<double>(std::max<std::uint64_t>(1, points->pointCount()));
    const double level = points->levelOfShare(std::min(1.0, static_cast<double>(wanted) / all));
    for (std::uint32_t n = 0; n < points->nodes().size(); ++n) {
      if (progress.cancelled()) return fail(cancelledError());
      const std::uint32_t count = points->countBelow(n, level);
      if (count == 0) continue;
      PointBatch batch = points->batch(points->nodes()[n].first, count);
      if (!sink(batch)) return {};
    }
    return {};
  };
  return source;
}

}  // namespace

ScanSource scanSourceOf(const ScanReader& reader, const std::string& path, const ScanInfo& info,
                        std::vector<ImportWarning>* warnings) {
  ScanSource source;
  source.name = path;
  source.identity = identityOf(path, reader.description().id);
  source.info = info;
  if (auto notes = reader.notes(path)) source.notes = std::move(*notes);
  source.read = [&reader, path, warnings](const ScanSource::Sink& sink, const Progress& progress) -> Result<void> {
    const auto read = reader.read(path, sink, progress);
    if (!read) return fail(read.error());
    if (warnings != nullptr) addOnce(*read, *warnings);
    return {};
  };
  if (reader.readsAnyOrder())
    source.readAnyOrder = [&reader, path, warnings](const ScanSource::NumberedSink& sink, const Progress& progress) -> Result<void> {
      const auto read = reader.readAnyOrder(path, sink, progress);
      if (!read) return fail(read.error());
      if (warnings != nullptr) addOnce(*read, *warnings);
      return {};
    };
  source.readRecords = [&reader, path, warnings](const RecordSink& sink, const Progress& progress) -> Result<bool> {
    const auto read = reader.readRecords(path, sink, progress);
    if (!read) return fail(read.error());
    if (*read && warnings != nullptr) addOnce(**read, *warnings);
    return read->has_value();
  };
  source.sample = [&reader, path](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress& progress) {
    return reader.sample(path, wanted, sink, progress);
  };
  return source;
}

Result<ScanSource> openScan(const std::string& path, std::vector<ImportWarning>* warnings) {
  if (isStoreFolder(path)) {
    const auto store = openStore(path);
    if (!store) return fail(store.error());
    std::vector<ScanSource> parts;
    for (const StorePart& part : store->parts) parts.push_back(scanSourceOf(part, path));
    if (parts.size() == 1) return std::move(parts.front());
    return joinScans(std::move(parts), warnings);
  }
  const auto reader = ReaderRegistry::instance().findAs<ScanReader>(path);
  if (!reader) return fail(reader.error());
  const auto info = (*reader)->inspect(path);
  if (!info) return fail(info.error());
  return scanSourceOf(**reader, path, *info, warnings);
}

}  // namespace alidade
