// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/scan_loading.h"

#include <algorithm>

#include <fmt/format.h>

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

}  // namespace

Result<std::vector<ScanLayer>> loadScan(const Scan& scan, int number, std::vector<ImportWarning>& warnings,
                                        const Progress& progress) {
  auto store = readStore(scan, warnings, progress.part(0.0, 0.8));
  if (!store) return fail(store.error());
  ScanLayer layer;
  layer.points = {*store, std::make_shared<const PointSummary>(summarise(**store)), number};
  layer.surface = surfaceOf(**store, scan.info.stations, progress.part(0.8, 1.0));
  if (progress.cancelled()) return fail(cancelledError());
  return std::vector<ScanLayer>{std::move(layer)};
}

}  // namespace alidade
