// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "pcd/pcd_reader.h"

#include <filesystem>

#include <fmt/format.h>

#include "pcd/pcd_body.h"

namespace alidade {

namespace {

constexpr std::size_t kBatch = 1 << 16;

/// What both inspect and read need first.
struct PcdStart {
  PcdHeader header;
  PointColumns columns;
};

Result<PcdStart> readStart(ByteStream& stream, const std::string& path) {
  auto header = readPcdHeader(stream, path);
  if (!header) return fail(header.error());
  std::vector<PointColumns::Column> columns;
  for (const PcdField& field : header->fields)
    columns.push_back({field.count == 1 ? field.name : std::string(), field.type});
  if (header->isOrganised()) {
    columns.push_back({"row", NumberType::U32});
    columns.push_back({"column", NumberType::U32});
  }
  auto made = PointColumns::make(columns);
  if (!made) return fail(made.error().in(path));
  if (auto ok = checkPcdRoom(stream, *header, path); !ok) return fail(ok.error());
  return PcdStart{std::move(*header), std::move(*made)};
}

bool hasViewpoint(const PcdHeader& header) {
  return header.viewpoint != std::array<double, 7>{0, 0, 0, 1, 0, 0, 0};
}

}  // namespace

ReaderDescription PcdReader::description() const {
  return {"pcd", "PCD point cloud", {"pcd"}};
}

int PcdReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  if (probe.startsWith("# .PCD")) return 100;
  if (probe.holds("FIELDS ") && probe.holds("DATA ") && probe.holds("POINTS ")) return 80;
  return probe.extension == "pcd" ? 20 : 0;
}

Result<ScanInfo> PcdReader::inspect(const std::string& path) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  ByteStream stream(*file);
  const auto start = readStart(stream, path);
  if (!start) return fail(start.error());
  static constexpr const char* kCodings[] = {"ascii", "binary", "binary compressed"};
  ScanInfo info;
  info.pointCount = start->header.points;
  info.attributes = start->columns.attributes();
  info.details = fmt::format("PCD {}, {}", start->header.version, kCodings[static_cast<int>(start->header.coding)]);
  if (start->header.isOrganised()) {
    Station station;
    station.rows = static_cast<std::uint32_t>(start->header.height);
    station.columns = static_cast<std::uint32_t>(start->header.width);
    info.stations.push_back(station);
    info.details += fmt::format(", {} rows of {}", station.rows, station.columns);
  }
  return info;
}

Result<std::vector<ImportWarning>> PcdReader::read(const std::string& path,
                                                   const BatchSink& sink,
                                                   const Progress& progress) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  ByteStream stream(*file);
  auto start = readStart(stream, path);
  if (!start) return fail(start.error());
  const PcdHeader& header = start->header;
  PointColumns& columns = start->columns;

  const std::string what = "Reading " + std::filesystem::path(path).filename().string();
  std::vector<double> values(header.fields.size() + 2);
  std::uint64_t done = 0;
  bool wanted = true;
  const auto ok = readPcdRows(stream, header, path, [&](const double* row) {
    std::copy_n(row, header.fields.size(), values.begin());
    values[header.fields.size()] = static_cast<double>(done / header.width);
    values[header.fields.size() + 1] = static_cast<double>(done % header.width);
    columns.addRow(values.data());
    ++done;
    if (columns.rowCount() >= kBatch) wanted = sink(columns.take());
    if (done % kBatch != 0) return wanted;
    progress.report(static_cast<double>(done) / static_cast<double>(header.points), what);
    return wanted && !progress.cancelled();
  });
  if (!ok) return fail(ok.error());
  if (progress.cancelled()) return fail(cancelledError());
  if (wanted && columns.rowCount() > 0) sink(columns.take());
  progress.report(1.0, what);

  std::vector<ImportWarning> warnings;
  if (!header.slip.empty()) warnings.push_back({header.slip, "header"});
  if (hasViewpoint(header))
    warnings.push_back({"The file has a VIEWPOINT; coordinates are used as they stand, without it", "header"});
  if (columns.droppedCount() > 0)
    warnings.push_back({fmt::format("{} points without usable coordinates were left out", columns.droppedCount()), "points"});
  return warnings;
}

}  // namespace alidade
