// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/ptx_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "plugin_api/text_file.h"
#include "text-scan/number_row.h"
#include "text-scan/text_lines.h"

namespace alidade {

namespace {

constexpr std::size_t kBatch = 1 << 16;
constexpr double kLargestCoordinate = 1e12;
constexpr std::size_t kMostScans = 65535;  // PointBatch::scanner
const std::string kCopyAgain = "Copy or export the file again";

struct PtxScan {
  std::uint64_t columns = 0, rows = 0;
  glm::dmat3 axes{1.0};  ///< world = axes * local + translation
  glm::dvec3 translation{0};
  bool rigid = true;

  Station station(std::size_t index) const {
    return {fmt::format("Scan {}", index + 1), RigidTransform::fromMatrix(axes, translation), static_cast<std::uint32_t>(rows),
            static_cast<std::uint32_t>(columns)};
  }
};

/// The next line that holds something; error at the end of the file.
Result<std::string_view> nextFilled(TextLines& lines) {
  std::string_view line;
  do {
    const auto more = lines.next(line);
    if (!more) return fail(more.error());
    if (!*more) return fail("The PTX file ends within a scan's header", lines.place(), kCopyAgain);
  } while (trimmed(line).empty());
  return line;
}

Result<NumberRow> numbers(TextLines& lines, int count, const char* what) {
  const auto line = nextFilled(lines);
  if (!line) return fail(line.error());
  NumberRow row;
  std::string_view wrong;
  if (parseRow(*line, {}, row, wrong) != count)
    return fail(fmt::format("{} is not {} of a PTX scan", quotedWords(*line), what), lines.place(), "Export the scan as PTX again");
  for (int i = 0; i < count; ++i)
    if (!(std::abs(row[static_cast<std::size_t>(i)]) <= kLargestCoordinate))
      return fail(fmt::format("A number in {} is not finite or beyond 1e12", what), lines.place(), "Export the scan as PTX again");
  return row;
}

/// Orthonormal axes nearest to the given ones by Gram and Schmidt; identity where they have none.
glm::dmat3 orthonormal(const glm::dmat3& m) {
  const glm::dvec3 x = m[0];
  const glm::dvec3 z = glm::cross(x, m[1]);
  if (!(glm::length(x) > 1e-9) || !(glm::length(z) > 1e-9)) return glm::dmat3(1.0);
  const glm::dvec3 unitX = glm::normalize(x), unitZ = glm::normalize(z);
  return {unitX, glm::cross(unitZ, unitX), unitZ};
}

/// A scan's ten lines; nothing at the end of the file.
Result<std::optional<PtxScan>> nextScan(TextLines& lines) {
  std::string_view line;
  do {
    const auto more = lines.next(line);
    if (!more) return fail(more.error());
    if (!*more) return std::optional<PtxScan>();
  } while (trimmed(line).empty());
  PtxScan scan;
  const auto sizeOf = [&](std::string_view text, const char* what, std::uint64_t& into) -> Result<void> {
    const auto value = parseInteger(trimmed(text));
    if (!value || *value < 0 || *value > INT32_MAX)
      return fail(fmt::format("{} is no number of {}", quotedWords(text), what), lines.place(), "Export the scan as PTX again");
    into = static_cast<std::uint64_t>(*value);
    return {};
  };
  if (auto ok = sizeOf(line, "columns", scan.columns); !ok) return fail(ok.error());
  const auto second = nextFilled(lines);
  if (!second) return fail(second.error());
  if (auto ok = sizeOf(*second, "rows", scan.rows); !ok) return fail(ok.error());
  const std::uint64_t start = lines.number();
  for (const char* what : {"the position", "an axis", "an axis", "an axis"})
    if (const auto row = numbers(lines, 3, what); !row) return fail(row.error());
  for (int i = 0; i < 4; ++i) {
    const auto row = numbers(lines, 4, "a row of the transform");
    if (!row) return fail(row.error());
    const glm::dvec3 values((*row)[0], (*row)[1], (*row)[2]);
    if (i < 3) scan.axes[i] = values;
    else scan.translation = values;
  }
  const glm::dmat3 nearest = orthonormal(scan.axes);
  for (int i = 0; i < 3; ++i) scan.rigid = scan.rigid && glm::length(nearest[i] - scan.axes[i]) < 1e-3;
  // "0 0 0 0" and its end are the shortest direction.
  if (scan.columns * scan.rows > (lines.remaining() + 1) / 8)
    return fail(fmt::format("The scan promises {} × {} points, but the file has room for {} at most", scan.columns, scan.rows,
                            (lines.remaining() + 1) / 8), placeInFile(lines.path(), start), kCopyAgain);
  return scan;
}

/// Gathers the points of one scan.
class PtxBatch {
 public:
  PtxBatch(const PtxScan& scan, std::uint16_t scanner) : m_scan(scan), m_scanner(scanner) {}

  void add(const NumberRow& row, int count, std::uint64_t index) {
    const glm::dvec3 local(row[0], row[1], row[2]);
    if (local == glm::dvec3(0)) {
      ++withoutReturn;
      return;
    }
    const glm::dvec3 world = m_scan.axes * local + m_scan.translation;
    if (!(std::abs(world.x) <= kLargestCoordinate && std::abs(world.y) <= kLargestCoordinate && std::abs(world.z) <= kLargestCoordinate)) {
      ++unusable;
      return;
    }
    m_batch.position.push_back(world);
    m_batch.intensity.push_back(row[3] > 0 ? static_cast<std::uint16_t>(std::min(row[3], 1.0) * 65535 + 0.5) : std::uint16_t(0));
    m_raw.push_back(static_cast<float>(row[3]));
    // A colour in some rows only is black in the others.
    if (count == 7 && m_batch.rgb.empty()) m_batch.rgb.resize(m_batch.size() - 1);
    if (count == 7 || !m_batch.rgb.empty()) {
      glm::u16vec3 colour(0);
      for (int k = 0; k < 3 && count == 7; ++k) colour[k] = static_cast<std::uint16_t>(std::clamp(row[static_cast<std::size_t>(4 + k)], 0.0, 255.0));
      m_batch.rgb.push_back(colour);
    }
    m_batch.scanner.push_back(m_scanner);
    m_batch.column.push_back(static_cast<std::uint32_t>(index / m_scan.rows));
    m_batch.row.push_back(static_cast<std::uint32_t>(index % m_scan.rows));
  }
  std::size_t size() const { return m_batch.size(); }
  PointBatch take() {
    ExtraColumn raw{"intensity", NumberType::F32, 1, {}};
    const auto bytes = std::as_bytes(std::span(m_raw));
    raw.data.assign(bytes.begin(), bytes.end());
    m_batch.extra.push_back(std::move(raw));
    m_raw.clear();
    return std::exchange(m_batch, {});
  }

  std::uint64_t withoutReturn = 0, unusable = 0;

 private:
  const PtxScan& m_scan;
  std::uint16_t m_scanner;
  PointBatch m_batch;
  std::vector<float> m_raw;
};

Error tooManyScans(const TextLines& lines) { return {fmt::format("The file has more than {} scans", kMostScans), lines.place(), "Split the file"}; }

}  // namespace

ReaderDescription PtxReader::description() const { return {"ptx", "PTX scan", {"ptx"}}; }

int PtxReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  LineReader lines(std::string_view(reinterpret_cast<const char*>(probe.head.data()), probe.head.size()));
  const int wanted[] = {1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
  std::string_view line, wrong;
  for (const int count : wanted) {
    NumberRow row;
    if (!lines.next(line) || parseRow(line, {}, row, wrong) != count) return probe.extension == "ptx" ? 30 : 0;
  }
  return 90;
}

Result<ScanInfo> PtxReader::inspect(const std::string& path) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  auto lines = TextLines::open(*file);
  if (!lines) return fail(lines.error());
  ScanInfo info;
  bool colour = false;
  std::string_view line, wrong;
  for (;;) {
    const auto scan = nextScan(*lines);
    if (!scan) return fail(scan.error());
    if (!*scan) break;
    if (info.stations.size() >= kMostScans) return fail(tooManyScans(*lines));
    info.stations.push_back((*scan)->station(info.stations.size()));
    const std::uint64_t count = (*scan)->columns * (*scan)->rows;
    info.pointCount += count;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto more = lines->next(line);
      if (!more) return fail(more.error());
      if (!*more) return fail(fmt::format("The PTX file ends after {} of {} points of its scan {}", i, count, info.stations.size()), lines->place(), kCopyAgain);
      NumberRow row;
      if (i < 1000 && !colour) colour = parseRow(line, {}, row, wrong) == 7;
    }
  }
  if (info.stations.empty()) return fail("The PTX file is empty", path, kCopyAgain);
  if (colour) info.attributes.push_back("rgb");
  info.attributes.insert(info.attributes.end(), {"intensity", "scanner", "row", "column"});
  info.details = fmt::format("PTX, {} scan{}; directions without a return are counted as points", info.stations.size(), info.stations.size() == 1 ? "" : "s");
  return info;
}

Result<std::vector<ImportWarning>> PtxReader::read(const std::string& path, const BatchSink& sink, const Progress& progress) const {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  auto lines = TextLines::open(*file);
  if (!lines) return fail(lines.error());
  const std::string what = "Reading " + std::filesystem::path(path).filename().string();
  std::vector<ImportWarning> warnings;
  std::string_view line, wrong;
  for (std::size_t index = 0;; ++index) {
    const auto scan = nextScan(*lines);
    if (!scan) return fail(scan.error());
    if (!*scan) {
      if (index == 0) return fail("The PTX file is empty", path, kCopyAgain);
      break;
    }
    if (index >= kMostScans) return fail(tooManyScans(*lines));
    const std::string name = (*scan)->station(index).name;
    if (!(*scan)->rigid) warnings.push_back({"The transform is no rigid motion; it was applied as it stands", name});
    PtxBatch batch(**scan, static_cast<std::uint16_t>(index));
    const std::uint64_t count = (*scan)->columns * (*scan)->rows;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto more = lines->next(line);
      if (!more) return fail(more.error());
      if (!*more) return fail(fmt::format("The PTX file ends after {} of {} points of its scan {}", i, count, index + 1), lines->place(), kCopyAgain);
      NumberRow row;
      const int numbers = parseRow(line, {}, row, wrong);
      if (numbers != 4 && numbers != 7)
        return fail(numbers < 0 ? fmt::format("{} is no number", quotedWords(wrong)) : fmt::format("The point has {} numbers, not 4 or 7", numbers),
                    lines->place(), kCopyAgain);
      batch.add(row, numbers, i);
      if (batch.size() < kBatch && i + 1 < count) continue;
      progress.report(lines->fraction(), what);
      if (progress.cancelled()) return fail(cancelledError());
      if (batch.size() == 0) continue;
      PointBatch points = batch.take();
      if (!sink(points)) return warnings;
    }
    if (batch.withoutReturn > 0)
      warnings.push_back({fmt::format("{} directions without a return were left out", batch.withoutReturn), name});
    if (batch.unusable > 0) warnings.push_back({fmt::format("{} points without usable coordinates were left out", batch.unusable), name});
  }
  progress.report(1.0, what);
  return warnings;
}

}  // namespace alidade
