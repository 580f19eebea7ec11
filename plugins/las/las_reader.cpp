// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_reader.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "las/las_header.h"
#include "las/las_points.h"

namespace alidade {

namespace {

/// What looks at the header alone trusts its bounds: say so where the points are not in them.
void checkBounds(LasHeader& header, const Bounds& found) {
  if (found.empty() || header.bounds.empty()) return;
  const glm::dvec3 step = 1.01 * header.scale;
  if (glm::any(glm::lessThan(found.min, header.bounds.min - step)) ||
      glm::any(glm::greaterThan(found.max, header.bounds.max + step)))
    header.warnings.push_back({fmt::format("Points lie outside the header's bounds: they span {:.3f} {:.3f} {:.3f} to "
                                           "{:.3f} {:.3f} {:.3f}",
                                           found.min.x, found.min.y, found.min.z, found.max.x, found.max.y,
                                           found.max.z),
                               "header offset 179"});
}

}  // namespace

ReaderDescription LasReader::description() const {
  return {"las", "LAS point cloud", {"las", "laz"}};
}

int LasReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  if (probe.startsWith("LASF")) return 100;
  // An empty or damaged file of this name is still answered here, with what is wrong with it.
  return probe.extension == "las" || probe.extension == "laz" ? 20 : 0;
}

Result<ScanInfo> LasReader::inspect(const std::string& path) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  const auto header = readLasHeader(*file);
  if (!header) return fail(header.error());
  ScanInfo info;
  info.pointCount = header->pointCount;
  info.bounds = header->bounds;
  info.crs = header->crs;
  info.scale = header->scale;
  info.offset = header->offset;
  if (header->hasRgb()) info.attributes.push_back("rgb");
  info.attributes.insert(info.attributes.end(), {"intensity", "classification", "return_number"});
  if (header->hasGpsTime()) info.attributes.push_back("gps_time");
  info.attributes.push_back("point_source_id");
  for (const auto& extra : header->extras)
    if (!extra.name.empty()) info.attributes.push_back(extra.name);
  info.details = header->details();
  return info;
}

Result<std::vector<ImportWarning>> LasReader::read(const std::string& path,
                                                   const BatchSink& sink,
                                                   const Progress& progress) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  auto header = readLasHeader(*file);
  if (!header) return fail(header.error());
  const auto unshifted = lasColoursAreUnshifted(*file, *header, progress.part(0.0, 0.1));
  if (!unshifted) return fail(unshifted.error());
  if (*unshifted)
    header->warnings.push_back({"Colours are stored as 8-bit numbers, against the standard; they are used as such",
                                "points"});

  const std::string what = "Reading " + std::filesystem::path(path).filename().string();
  const std::uint64_t batchSize = lasBatchSize(*header);
  std::vector<std::byte> bytes(std::min(batchSize, header->pointCount) * header->recordLength);
  const Progress reading = progress.part(0.1, 1.0);
  PointBatch batch;
  Bounds found;
  for (std::uint64_t first = 0; first < header->pointCount; first += batchSize) {
    if (progress.cancelled()) return fail(cancelledError());
    reading.report(static_cast<double>(first) / static_cast<double>(header->pointCount), what);
    const std::uint64_t count = std::min(batchSize, header->pointCount - first);
    const auto part = std::span(bytes).first(count * header->recordLength);
    if (auto ok = file->readAt(header->pointsOffset + first * header->recordLength, part); !ok)
      return fail(ok.error());
    decodeLasPoints(*header, part.data(), count, *unshifted, batch);
    for (const auto& position : batch.position) found.add(position);
    if (!sink(batch)) break;
  }
  checkBounds(*header, found);
  reading.report(1.0, what);
  return header->warnings;
}

}  // namespace alidade
