// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/derived_scan.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/scan_loading.h"
#include "app/scan_source.h"
#include "io/project_store.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

Result<const Scan*> scanOf(const Project& project, ScanId id) {
  for (const Scan& scan : project.scans)
    if (scan.id == id) return &scan;
  return fail("The project holds no such scan", project.path);
}

/// "hall cleaned.laz", "hall cleaned 2.laz", …: the first that is not there.
std::string freshPath(const Project& project, const Scan& scan, const std::string& what) {
  const fs::path source = scan.source.path;
  const fs::path folder = (project.path.empty() ? source : fs::path(project.path)).parent_path();
  const std::string stem = fmt::format("{} {}", source.stem().string(), what);
  std::error_code ignored;
  for (int i = 1;; ++i) {
    const fs::path path = folder / (i == 1 ? fmt::format("{}.laz", stem) : fmt::format("{} {}.laz", stem, i));
    if (!fs::exists(path, ignored)) return path.string();
  }
}

Result<DerivedScan> opened(const Project& project, const std::string& path, const Progress& progress) {
  DerivedScan derived;
  const auto source = openScan(path, &derived.warnings);
  if (!source) return fail(source.error());
  auto described = describeSource(path);
  if (!described) return fail(described.error());
  derived.scan.name = fs::path(path).stem().string();
  derived.scan.source = std::move(*described);
  derived.scan.info = source->info;
  auto layers = loadScan(derived.scan, static_cast<int>(project.scans.size()), derived.warnings, progress);
  if (!layers) return fail(layers.error());
  derived.layers = std::move(*layers);
  return derived;
}

std::string reportOf(const ScanCleaningSummary& summary, const ScanCleaning& cleaning) {
  std::string report = fmt::format("{} of {} points kept", summary.written, summary.read);
  if (cleaning.outliers) report += fmt::format("\n{} outliers dropped", summary.outliers);
  if (cleaning.radius) report += fmt::format("\n{} lonely points dropped", summary.lonely);
  if (cleaning.voxelMeters) report += fmt::format("\n{} points thinned out", summary.thinned);
  if (cleaning.ground) report += fmt::format("\n{} points are ground", summary.ground);
  for (const std::string& note : summary.notes) report += '\n' + note;
  return report;
}

}  // namespace

Result<DerivedScan> deriveCleaned(const Project& project, ScanId id, const ScanCleaning& cleaning, const Progress& progress) {
  const auto scan = scanOf(project, id);
  if (!scan) return fail(scan.error());
  const std::string target = freshPath(project, **scan, "cleaned");
  const auto summary = cleanScan((*scan)->source.path, target, cleaning, progress.part(0, 0.8));
  if (!summary) return fail(summary.error());
  auto derived = opened(project, target, progress.part(0.8, 1));
  if (derived) derived->report = reportOf(*summary, cleaning);
  return derived;
}

Result<DerivedScan> deriveRegistered(const Project& project, ScanId movingId, ScanId fixedId, const RegistrationOptions& options,
                                     const Progress& progress) {
  const auto moving = scanOf(project, movingId), fixed = scanOf(project, fixedId);
  if (!moving) return fail(moving.error());
  if (!fixed) return fail(fixed.error());
  if (movingId == fixedId) return fail("A scan is not fitted to itself", (*moving)->name, "Choose another scan to fit it to");
  const auto found = registerScanFiles((*moving)->source.path, (*fixed)->source.path, options, progress.part(0, 0.6));
  if (!found) return fail(found.error());
  const std::string target = freshPath(project, **moving, "registered");
  if (auto ok = moveScan((*moving)->source.path, target, found->fixedFromMoving, progress.part(0.6, 0.8)); !ok) return fail(ok.error());
  auto derived = opened(project, target, progress.part(0.8, 1));
  if (derived) derived->report = found->report();
  return derived;
}

}  // namespace alidade
