// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/e57_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "e57/batch_maker.h"
#include "e57/record_reader.h"

namespace alidade {

namespace {

constexpr std::size_t kBatch = 1 << 16;
constexpr std::size_t kWalking = 512, kLooking = 1;  // pages read at once

/// What inspect, read and sample need first.
struct E57Start {
  PagedFile file;
  E57Document document;
  std::uint64_t total = 0;       ///< records
  std::uint16_t rgbWhite = 255;  ///< one for all scans of the file
};

Result<E57Start> openE57(const std::string& path) {
  auto file = PagedFile::open(path);
  if (!file) return fail(file.error());
  auto document = readE57Document(*file);
  if (!document) return fail(document.error());
  E57Start start{std::move(*file), std::move(*document)};
  std::uint64_t sections = 0;
  for (const E57Scan& scan : start.document.scans) {
    const auto records = RecordReader::open(start.file, scan, kLooking);
    if (!records) return fail(records.error());
    const auto maker = BatchMaker::make(scan, 0, 255);
    if (!maker) return fail(maker.error().in(path));
    start.total += scan.recordCount;
    sections += records->sectionLength();
    if (BatchMaker::hasDeepColour(scan)) start.rgbWhite = 65535;
    if (scan.recordCount == 0 && scan.fileOffset == 0)
      start.document.warnings.push_back({"The scan has no points, nor a section for them", scan.name});
  }
  // Scans that share one section would be read over and over.
  if (sections > start.file.logicalSize())
    return fail("The scans' point sections overlap", path, "Export the file again");
  return start;
}

/// World bounds; empty where a scan with points does not state its own.
Bounds boundsOf(const E57Document& document) {
  Bounds bounds;
  for (const E57Scan& scan : document.scans) {
    if (scan.recordCount == 0) continue;
    if (scan.localBounds.empty()) return {};
    for (int i = 0; i < 8; ++i) bounds.add(scan.worldFromScanner * scan.localBounds.corner(i));
  }
  return bounds;
}

/// Where all scans keep their coordinates as integers of one step and none is moved.
void takeSteps(const E57Document& document, ScanInfo& info) {
  bool first = true;
  for (const E57Scan& scan : document.scans) {
    if (scan.recordCount == 0) continue;
    const auto maker = BatchMaker::make(scan, 0, 255);
    glm::dvec3 scale(0), offset(0);
    for (int axis = 0; axis < 3; ++axis) {
      const E57Field* field = maker ? maker->cartesian(axis) : nullptr;
      if (!field || field->kind != E57Field::Kind::ScaledInteger) continue;
      scale[axis] = field->scale;
      offset[axis] = field->offset;
    }
    const RigidTransform& pose = scan.worldFromScanner;
    const bool moved = pose.rotation != glm::dquat(1, 0, 0, 0) || pose.translation != glm::dvec3(0);
    const bool differs = !first && (scale != info.scale || offset != info.offset);
    if (moved || differs || glm::any(glm::lessThanEqual(scale, glm::dvec3(0)))) {
      info.scale = info.offset = glm::dvec3(0);
      return;
    }
    info.scale = scale;
    info.offset = offset;
    first = false;
  }
}

std::string detailsOf(const E57Start& start) {
  const E57Document& document = start.document;
  const auto plural = [](std::size_t n, const char* word) { return fmt::format("{} {}{}", n, word, n == 1 ? "" : "s"); };
  std::string details = fmt::format("E57 {}.{}, {}", start.file.versionMajor(), start.file.versionMinor(), plural(document.scans.size(), "scan"));
  if (!document.images.empty()) details += ", " + plural(document.images.size(), "picture");
  if (!document.library.empty()) details += ", written by " + document.library;
  return details;
}

std::string readingOf(const std::string& path) { return "Reading " + std::filesystem::path(path).filename().string(); }

}  // namespace

ReaderDescription E57Reader::description() const { return {"e57", "E57 scan", {"e57"}}; }

int E57Reader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  return probe.startsWith("ASTM-E57") ? 100 : probe.extension == "e57" ? 20 : 0;
}

Result<ScanInfo> E57Reader::inspect(const std::string& path) const {
  const auto start = openE57(path);
  if (!start) return fail(start.error());
  ScanInfo info;
  info.pointCount = start->total;
  info.bounds = boundsOf(start->document);
  info.crs = start->document.crs;
  takeSteps(start->document, info);
  for (const E57Scan& scan : start->document.scans) {
    const auto maker = BatchMaker::make(scan, 0, 255);
    if (!maker) return fail(maker.error().in(path));
    info.stations.push_back({scan.name, scan.worldFromScanner, maker->gridSize(true), maker->gridSize(false)});
    if (scan.recordCount == 0) continue;
    for (const std::string& name : maker->attributes())
      if (std::find(info.attributes.begin(), info.attributes.end(), name) == info.attributes.end()) info.attributes.push_back(name);
  }
  info.details = detailsOf(*start);
  return info;
}

Result<std::vector<ImportWarning>> E57Reader::read(const std::string& path, const BatchSink& sink, const Progress& progress) const {
  auto start = openE57(path);
  if (!start) return fail(start.error());
  std::vector<ImportWarning> warnings = std::move(start->document.warnings);
  const std::string what = readingOf(path);
  std::uint64_t done = 0;
  RecordColumns columns;
  PointBatch batch;
  for (std::size_t index = 0; index < start->document.scans.size(); ++index) {
    const E57Scan& scan = start->document.scans[index];
    auto records = RecordReader::open(start->file, scan, kWalking);
    if (!records) return fail(records.error());
    auto maker = BatchMaker::make(scan, static_cast<std::uint16_t>(index), start->rgbWhite);
    if (!maker) return fail(maker.error().in(path));
    while (records->recordsLeft() > 0) {
      if (progress.cancelled()) return fail(cancelledError());
      const auto count = records->next(kBatch, columns);
      if (!count) return fail(count.error());
      maker->fill(columns, *count, batch);
      done += *count;
      progress.report(static_cast<double>(done) / static_cast<double>(start->total), what);
      if (batch.size() > 0 && !sink(batch)) return warnings;
    }
    if (maker->withoutReturn() > 0)
      warnings.push_back({fmt::format("{} directions without a return were left out", maker->withoutReturn()), scan.name});
    if (maker->unusable() > 0)
      warnings.push_back({fmt::format("{} points without usable coordinates were left out", maker->unusable()), scan.name});
    for (const E57Field& field : scan.fields)
      if (field.kind == E57Field::Kind::String) warnings.push_back({"The text column " + field.name + " was left out", scan.name});
  }
  for (const E57Image& image : start->document.images)
    if (image.projection == E57Image::Projection::Spherical || image.projection == E57Image::Projection::Cylindrical)
      warnings.push_back({fmt::format("The picture '{}' is a {} panorama, which no camera model covers yet", image.name,
                                      image.projection == E57Image::Projection::Spherical ? "spherical" : "cylindrical"), "images2D"});
  progress.report(1.0, what);
  return warnings;
}

Result<void> E57Reader::sample(const std::string& path, std::uint64_t wanted, const BatchSink& sink, const Progress& progress) const {
  const auto start = openE57(path);
  if (!start) return fail(start.error());
  if (wanted == 0 || start->total == 0) return {};
  const double share = std::min(1.0, static_cast<double>(wanted) / static_cast<double>(start->total));
  // Some hundred points a packet: neighbours in the scan tell little more than one of them.
  const double packets = std::clamp(static_cast<double>(wanted) / 256.0, 64.0, 20000.0);
  const auto stride = static_cast<std::uint64_t>(static_cast<double>(start->total) / packets) + 1;
  const std::string what = readingOf(path);
  std::uint64_t done = 0;
  RecordColumns columns;
  PointBatch batch;
  for (std::size_t index = 0; index < start->document.scans.size(); ++index) {
    const E57Scan& scan = start->document.scans[index];
    auto records = RecordReader::open(start->file, scan, kLooking);
    if (!records) return fail(records.error());
    auto maker = BatchMaker::make(scan, static_cast<std::uint16_t>(index), start->rgbWhite);
    if (!maker) return fail(maker.error().in(path));
    std::uint64_t from = 0, first = 0, end = 0;
    while (from < scan.recordCount) {
      if (progress.cancelled()) return fail(cancelledError());
      const auto count = records->nextFrom(from, kBatch, columns, first, end);
      if (!count) return fail(count.error());
      if (*count == 0) break;
      maker->fill(columns, *count, batch);
      // This packet stands for all records from the one asked for to the next that will be.
      const std::uint64_t next = std::max(end, from + stride);
      const double points = share * static_cast<double>(std::min(next, scan.recordCount) - from);
      const auto step = static_cast<std::size_t>(std::max(1.0, static_cast<double>(*count) / std::max(points, 1.0)));
      from = next;
      progress.report(static_cast<double>(done + std::min(from, scan.recordCount)) / static_cast<double>(start->total), what);
      if (batch.size() == 0) continue;
      PointBatch some = batch.every(0, step);
      if (!sink(some)) return {};
    }
    done += scan.recordCount;
  }
  return {};
}

}  // namespace alidade
