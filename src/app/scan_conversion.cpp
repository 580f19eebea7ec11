// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_conversion.h"

#include <cmath>
#include <filesystem>
#include <span>

#include <fmt/format.h>

#include "app/copc_tree.h"
#include "app/scan_join.h"
#include "app/scan_source.h"
#include "cloud/store_folder.h"
#include "cloud/store_index.h"
#include "io/reader_registry.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;

Result<ScanSource> openJoined(const std::vector<std::string>& paths, std::vector<ImportWarning>& warnings) {
  std::vector<ScanSource> scans;
  for (const std::string& path : paths) {
    auto scan = openScan(path, &warnings);
    if (!scan) return fail(scan.error());
    scans.push_back(std::move(*scan));
  }
  return joinScans(std::move(scans), &warnings);
}

Result<Bounds> boundsOf(const ScanSource& scan, const Progress& progress) {
  Bounds bounds;
  const auto read = scan.read(
      [&](PointBatch& batch) {
        for (const glm::dvec3& p : batch.position)
          if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) bounds.add(p);
        return true;
      },
      progress);
  if (!read) return fail(read.error());
  if (progress.cancelled()) return fail(cancelledError());
  return bounds;
}

Result<void> writeFlat(const ScanSource& scan, const ScanWriter& writer, const std::string& target, ScanConversion& done,
                       const Progress& progress) {
  ScanWriteOptions options;
  options.info = scan.info, options.notes = scan.notes;
  // Steps fit to the scan are chosen by its bounds, which a file of floating numbers need not state.
  if (!glm::all(glm::greaterThan(options.info.scale, glm::dvec3(0))) && options.info.bounds.empty()) {
    auto bounds = boundsOf(scan, progress.part(0, 0.4));
    if (!bounds) return fail(bounds.error());
    options.info.bounds = *bounds;
  }
  auto sink = writer.create(target, options);
  if (!sink) return fail(sink.error());
  Result<void> added;
  const auto read = scan.read(
      [&](PointBatch& batch) {
        done.points += batch.size();
        added = (*sink)->add(batch, {});
        return added.has_value();
      },
      progress.part(0.4, 1));
  if (!read) return fail(read.error());
  if (!added) return fail(added.error());
  if (auto ok = (*sink)->finish(); !ok) return fail(ok.error());
  done.warnings = (*sink)->remarks();
  return {};
}

/// A store for the while of a conversion.
class PassingStore {
 public:
  explicit PassingStore(const std::string& target) : m_path(target + ".alidade-points") {}
  PassingStore(const PassingStore&) = delete;
  ~PassingStore() {
    std::error_code ignored;
    if (m_ours) fs::remove_all(m_path, ignored);
  }

  Result<StoreFolder> make(ScanSource scan, ScanConversion& done, const Progress& progress) {
    std::error_code ignored;
    if (fs::exists(m_path, ignored)) return fail("The folder that the points are sorted in exists already", m_path, "Remove it");
    m_ours = true;
    scan.identity.clear();  // nobody goes on with it
    const auto report = indexScans(std::span(&scan, 1), m_path, {}, progress);
    if (!report) return fail(report.error());
    done.dropped = report->dropped;
    return openStore(m_path);
  }

 private:
  std::string m_path;
  bool m_ours = false;
};

Result<void> writeAsTree(const std::vector<std::string>& paths, const ScanWriter& writer, const std::string& target, ScanConversion& done,
                         std::vector<ImportWarning>& warnings, const Progress& progress) {
  const auto write = [&](const PointStore& store, const ScanInfo& info, const ScanNotes& notes, const Progress& part) -> Result<void> {
    done.points = store.pointCount();
    auto remarks = writeTree(store, info, notes, writer, target, part);
    if (!remarks) return fail(remarks.error());
    done.warnings = std::move(*remarks);
    return {};
  };
  if (paths.size() == 1 && isStoreFolder(paths.front())) {
    const auto store = openStore(paths.front());
    if (!store) return fail(store.error());
    if (store->parts.size() == 1) {
      const PartManifest& manifest = store->parts.front().manifest;
      return write(*store->parts.front().points, manifest.info, manifest.notes, progress);
    }
  }
  auto scan = openJoined(paths, warnings);
  if (!scan) return fail(scan.error());
  PassingStore passing(target);
  const auto store = passing.make(*scan, done, progress.part(0, 0.6));
  if (!store) return fail(store.error());
  return write(*store->parts.front().points, scan->info, scan->notes, progress.part(0.6, 1));
}

}  // namespace

Result<ScanConversion> convertScans(const std::vector<std::string>& scans, const std::string& target, const Progress& progress) {
  const auto writer = ReaderRegistry::instance().findWriter(target);
  if (!writer) return fail(writer.error());
  std::error_code ignored;
  for (const std::string& path : scans)
    if (fs::equivalent(path, target, ignored)) return fail("A scan cannot be converted onto itself", target, "Name another file");
  ScanConversion done;
  done.format = (*writer)->description().id;
  std::vector<ImportWarning> warnings;
  if ((*writer)->isTree()) {
    if (auto ok = writeAsTree(scans, **writer, target, done, warnings, progress); !ok) return fail(ok.error());
  } else {
    const auto scan = openJoined(scans, warnings);
    if (!scan) return fail(scan.error());
    if (auto ok = writeFlat(*scan, **writer, target, done, progress); !ok) return fail(ok.error());
  }
  for (const ImportWarning& warning : warnings)
    done.warnings.push_back(fmt::format("{}: {}", warning.where, warning.what));
  if (done.dropped > 0) done.warnings.push_back(fmt::format("{} points without usable coordinates were left out", done.dropped));
  return done;
}

}  // namespace alidade
