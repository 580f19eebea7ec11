// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_reader.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "base/parallel.h"
#include "las/copc_hierarchy.h"
#include "las/las_header.h"
#include "las/las_points.h"
#include "las/las_runs.h"

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

/// A batch, made on any thread, and the bounds of all that were made in it.
struct MadeBatch {
  MadeBatch() = default;
  MadeBatch(const LasHeader& header, const RecordFormat& format, const std::byte* records, std::size_t count) {
    fill(header, format, records, count);
  }
  void fill(const LasHeader& header, const RecordFormat& format, const std::byte* records, std::size_t count) {
    decodeLasPoints(header, format, records, count, batch);
    Bounds here;  // in registers
    for (const auto& position : batch.position) here.add(position);
    bounds.add(here);
  }
  PointBatch batch;
  Bounds bounds;
};

/// The least and the largest of the numbers that records begin with, axis by axis.
std::pair<glm::ivec3, glm::ivec3> extentOf(const std::byte* records, std::size_t stride, std::size_t count) {
  using Four = std::int32_t __attribute__((vector_size(16)));  // the fourth is another field: records are longer
  Four low = Four{} + std::numeric_limits<std::int32_t>::max(), high = Four{} + std::numeric_limits<std::int32_t>::min();
  for (std::size_t i = 0; i < count; ++i) {
    const auto here = lasValue<Four>(records, i * stride);
    low = here < low ? here : low, high = here > high ? here : high;
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

std::string readingWords(const std::string& path) {
  return "Reading " + std::filesystem::path(path).filename().string();
}

/// Of the runs' points, or the first found that exceeds eight bits.
Result<std::uint16_t> largestColour(const ByteSource& file, const LasHeader& header, const std::vector<LasRun>& runs,
                                    const Progress& progress) {
  std::uint16_t overall = 0;
  if (!header.hasRgb()) return overall;
  const MakeBatch make = [&](const std::byte* records, std::size_t count) -> std::function<bool()> {
    return [&overall, largest = largestLasColour(header, records, count)] {
      overall = std::max(overall, largest);
      return overall <= 255;
    };
  };
  if (auto ok = readRuns(file, header, runs, make, progress, "Checking colours"); !ok) return fail(ok.error());
  return overall;
}

/// True where the colours are 8-bit numbers stored without the shift that the standard asks for: no
/// channel of any point exceeds 255, and some are not 0. A sample over the file settles the usual
/// case; only a file that looks unshifted is looked through to the end.
Result<bool> coloursAreUnshifted(const ByteSource& file, const LasHeader& header, const Progress& progress) {
  if (!header.hasRgb() || header.pointCount == 0) return false;
  const auto runs = runsOf(file, header);
  if (!runs) return fail(runs.error());
  if (!*runs) {
    std::uint16_t overall = 0;
    const MakeBatch make = [&](const std::byte* records, std::size_t count) -> std::function<bool()> {
      overall = std::max(overall, largestLasColour(header, records, count));
      return [&overall] { return overall <= 255; };
    };
    if (auto ok = readWithoutTable(file, header, make, progress, "Checking colours"); !ok) return fail(ok.error());
    return overall > 0 && overall <= 255;
  }
  constexpr std::uint64_t kSample = 10000;
  const auto sampled = largestColour(file, header, sampleOf(**runs, header, kSample), progress.part(0.0, 0.1));
  if (!sampled) return fail(sampled.error());
  if (*sampled > 255) return false;
  const auto all = largestColour(file, header, **runs, progress.part(0.1, 1.0));
  if (!all) return fail(all.error());
  return *all > 0 && *all <= 255;
}

/// A file that is about to be read to its end.
struct OpenedFile {
  std::shared_ptr<const ByteSource> file;
  LasHeader header;
  bool unshifted = false;  ///< coloursAreUnshifted

  static Result<OpenedFile> open(const std::string& path, const Progress& progress) {
    auto file = ByteSource::open(path);
    if (!file) return fail(file.error());
    auto header = readLasHeader(**file);
    if (!header) return fail(header.error());
    const auto unshifted = coloursAreUnshifted(**file, *header, progress);
    if (!unshifted) return fail(unshifted.error());
    if (*unshifted)
      header->warnings.push_back({"Colours are stored as 8-bit numbers, against the standard; they are used as such, and written as 16-bit numbers",
                                  "points"});
    return OpenedFile{std::move(*file), std::move(*header), *unshifted};
  }
};

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
  const auto file = ByteSource::open(path);
  if (!file) return fail(file.error());
  const auto header = readLasHeader(**file);
  if (!header) return fail(header.error());
  ScanInfo info;
  info.pointCount = header->pointCount;
  info.bounds = header->bounds;
  info.crs = header->crs;
  info.scale = header->scale;
  info.offset = header->offset;
  info.attributes = lasAttributes(*header);
  for (const LasStation& each : header->stations) info.stations.push_back(each.station);
  info.details = header->details();
  return info;
}

Result<ScanNotes> LasReader::notes(const std::string& path) const {
  const auto file = ByteSource::open(path);
  if (!file) return fail(file.error());
  const auto header = readLasHeader(**file);
  if (!header) return fail(header.error());
  return header->notes();
}

Result<std::vector<ImportWarning>> LasReader::read(const std::string& path,
                                                   const BatchSink& sink,
                                                   const Progress& progress) const {
  auto opened = OpenedFile::open(path, progress.part(0.0, 0.1));
  if (!opened) return fail(opened.error());
  LasHeader& header = opened->header;
  const RecordFormat format = lasRecordFormat(header, opened->unshifted);
  Bounds found;
  const MakeBatch make = [&](const std::byte* records, std::size_t count) -> std::function<bool()> {
    auto made = std::make_shared<MadeBatch>(header, format, records, count);
    return [made = std::move(made), &found, &sink] {
      found.add(made->bounds);
      return sink(made->batch);
    };
  };
  if (auto ok = readAllPoints(*opened->file, header, make, progress.part(0.1, 1.0), readingWords(path)); !ok)
    return fail(ok.error());
  checkBounds(header, found);
  return header.warnings;
}

Result<std::vector<ImportWarning>> LasReader::readAnyOrder(const std::string& path, const NumberedSink& sink,
                                                           const Progress& progress) const {
  auto opened = OpenedFile::open(path, progress.part(0.0, 0.1));
  if (!opened) return fail(opened.error());
  LasHeader& header = opened->header;
  const RecordFormat format = lasRecordFormat(header, opened->unshifted);
  std::vector<MadeBatch> batches(static_cast<std::size_t>(workerCount()));
  const TakeRecords take = [&](std::uint64_t first, const std::byte* records, std::size_t count, int worker) {
    MadeBatch& made = batches[static_cast<std::size_t>(worker)];
    made.fill(header, format, records, count);
    return sink(first, made.batch);
  };
  if (auto ok = alidade::readAnyOrder(*opened->file, header, take, progress.part(0.1, 1.0), readingWords(path)); !ok)
    return fail(ok.error());
  Bounds found;
  for (const MadeBatch& made : batches) found.add(made.bounds);
  checkBounds(header, found);
  return header.warnings;
}

Result<std::optional<std::vector<ImportWarning>>> LasReader::readRecords(const std::string& path, const RecordSink& sink,
                                                                         const Progress& progress) const {
  {
    const auto file = ByteSource::open(path);
    if (!file) return fail(file.error());
    const auto header = readLasHeader(**file);
    if (!header) return fail(header.error());
    if (!lasRecordsTellAll(*header)) return std::nullopt;
  }
  auto opened = OpenedFile::open(path, progress.part(0.0, 0.1));
  if (!opened) return fail(opened.error());
  LasHeader& header = opened->header;
  const RecordFormat format = lasRecordFormat(header, opened->unshifted);
  struct Extent {
    glm::ivec3 low{std::numeric_limits<std::int32_t>::max()}, high{std::numeric_limits<std::int32_t>::min()};
  };
  std::vector<Extent> extents(static_cast<std::size_t>(workerCount()));
  const TakeRecords take = [&](std::uint64_t first, const std::byte* records, std::size_t count, int worker) {
    const auto [low, high] = extentOf(records, format.bytes, count);
    Extent& extent = extents[static_cast<std::size_t>(worker)];
    extent.low = glm::min(extent.low, low), extent.high = glm::max(extent.high, high);
    return sink(first, {format, records, count, low, high});
  };
  if (auto ok = alidade::readAnyOrder(*opened->file, header, take, progress.part(0.1, 1.0), readingWords(path)); !ok)
    return fail(ok.error());
  Bounds found;
  for (const Extent& extent : extents) {
    if (extent.low.x > extent.high.x) continue;
    found.add(header.scale * glm::dvec3(extent.low) + header.offset);
    found.add(header.scale * glm::dvec3(extent.high) + header.offset);
  }
  checkBounds(header, found);
  return std::move(header.warnings);
}

Result<void> LasReader::sample(const std::string& path, std::uint64_t wanted, const BatchSink& sink,
                               const Progress& progress) const {
  const auto file = ByteSource::open(path);
  if (!file) return fail(file.error());
  const auto header = readLasHeader(**file);
  if (!header) return fail(header.error());
  if (header->pointCount == 0 || wanted == 0) return {};
  std::vector<LasRun> some;
  if (header->copc) {
    auto coarsest = CopcHierarchy(**file, *header).coarsest(wanted);
    if (!coarsest) return fail(coarsest.error());
    some = std::move(*coarsest);
  } else {
    const auto runs = runsOf(**file, *header);
    if (!runs) return fail(runs.error());
    if (!*runs) return ScanReader::sample(path, wanted, sink, progress);
    some = sampleOf(**runs, *header, wanted);
  }
  // What the sample shows of the colours decides, so that it is read once: it is held until all of it is there.
  const RecordFormat format = lasRecordFormat(*header, false);
  std::vector<std::shared_ptr<MadeBatch>> held;
  const MakeBatch make = [&](const std::byte* records, std::size_t count) -> std::function<bool()> {
    auto made = std::make_shared<MadeBatch>(*header, format, records, count);
    return [made = std::move(made), &held] {
      held.push_back(made);
      return true;
    };
  };
  if (auto ok = readRuns(**file, *header, some, make, progress, readingWords(path)); !ok) return ok;
  std::uint16_t largest = 0;
  for (const auto& made : held)
    for (const glm::u16vec3& rgb : made->batch.rgb) largest = std::max({largest, rgb.r, rgb.g, rgb.b});
  for (const auto& made : held) {
    made->batch.rgbWhite = largest > 0 && largest <= 255 ? 255 : 65535;
    if (!sink(made->batch)) break;
  }
  return {};
}

}  // namespace alidade
