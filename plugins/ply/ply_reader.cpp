// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ply/ply_reader.h"

#include <filesystem>

#include <fmt/format.h>

#include "ply/ply_body.h"

namespace alidade {

namespace {

constexpr std::size_t kBatch = 1 << 16;

/// What both inspect and read need first: the header, where it says there are points.
struct PlyStart {
  PlyHeader header;
  PointColumns columns;
  const PlyElement* vertices() const { return header.element("vertex"); }
};

Result<PlyStart> readStart(ByteStream& stream, const std::string& path) {
  auto header = readPlyHeader(stream, path);
  if (!header) return fail(header.error());
  const PlyElement* vertices = header->element("vertex");
  if (vertices == nullptr)
    return fail("The PLY file has no element \"vertex\", so no points", path, "Export the file again with its points");
  std::vector<PointColumns::Column> columns;
  for (const PlyProperty& property : vertices->properties)
    columns.push_back({property.listCountType ? std::string() : property.name, property.type});
  auto made = PointColumns::make(columns);
  if (!made) return fail(made.error().in(path));
  return PlyStart{std::move(*header), std::move(*made)};
}

std::uint64_t faceCount(const PlyHeader& header) {
  const PlyElement* faces = header.element("face");
  return faces == nullptr ? 0 : faces->count;
}

}  // namespace

ReaderDescription PlyReader::description() const {
  return {"ply", "PLY point cloud", {"ply"}};
}

int PlyReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  const bool signature = probe.startsWith("ply\n") || probe.startsWith("ply\r") || probe.startsWith("ply \n") ||
                         probe.startsWith("ply \r");
  if (!signature) return probe.extension == "ply" ? 20 : 0;
  // With faces it is rather a mesh, whose reader then claims more.
  const bool faces = probe.holds("element face ") && !probe.holds("element face 0");
  return faces ? 60 : 100;
}

Result<ScanInfo> PlyReader::inspect(const std::string& path) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  ByteStream stream(*file);
  const auto start = readStart(stream, path);
  if (!start) return fail(start.error());
  const PlyBody body(stream, start->header, path);
  if (auto ok = body.checkRoom(*start->vertices()); !ok) return fail(ok.error());
  ScanInfo info;
  info.pointCount = start->vertices()->count;
  info.attributes = start->columns.attributes();
  static constexpr const char* kCodings[] = {"ascii", "binary little endian", "binary big endian"};
  info.details = fmt::format("PLY, {}", kCodings[static_cast<int>(start->header.coding)]);
  if (const auto faces = faceCount(start->header); faces > 0) info.details += fmt::format(", also {} faces", faces);
  if (!start->header.comments.empty()) info.details += ", " + start->header.comments.front();
  return info;
}

Result<std::vector<ImportWarning>> PlyReader::read(const std::string& path,
                                                   const BatchSink& sink,
                                                   const Progress& progress) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  ByteStream stream(*file);
  auto start = readStart(stream, path);
  if (!start) return fail(start.error());
  PlyBody body(stream, start->header, path);
  const PlyElement& vertices = *start->vertices();
  for (const PlyElement& element : start->header.elements) {
    if (&element == &vertices) break;
    if (auto ok = body.skip(element); !ok) return fail(ok.error());
  }

  const std::string what = "Reading " + std::filesystem::path(path).filename().string();
  PointColumns& columns = start->columns;
  std::uint64_t done = 0;
  bool wanted = true;
  const auto ok = body.rows(vertices, [&](const double* values) {
    columns.addRow(values);
    ++done;
    if (columns.rowCount() >= kBatch) wanted = sink(columns.take());
    if (done % kBatch != 0) return wanted;
    progress.report(static_cast<double>(done) / static_cast<double>(vertices.count), what);
    return wanted && !progress.cancelled();
  });
  if (!ok) return fail(ok.error());
  if (progress.cancelled()) return fail(cancelledError());
  if (wanted && columns.rowCount() > 0) sink(columns.take());
  progress.report(1.0, what);

  std::vector<ImportWarning> warnings;
  if (columns.droppedCount() > 0)
    warnings.push_back({fmt::format("{} points without usable coordinates were left out", columns.droppedCount()), "vertex"});
  if (const auto faces = faceCount(start->header); faces > 0)
    warnings.push_back({fmt::format("{} faces were ignored: the file is read as points", faces), "face"});
  return warnings;
}

}  // namespace alidade
