// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/row_scan_reader.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::size_t kBatch = 1 << 16;

std::string_view separatorName(char separator) {
  switch (separator) {
    case ',': return "commas";
    case ';': return "semicolons";
    case '\t': return "tabs";
    default: return "blanks";
  }
}

std::string_view headOf(const FileProbe& probe) { return {reinterpret_cast<const char*>(probe.head.data()), probe.head.size()}; }

}  // namespace

Result<ScanInfo> RowScanReader::inspect(const std::string& path) const {
  const auto rows = openRowFile(path, dialect());
  if (!rows) return fail(rows.error());
  ScanInfo info;
  // No header counts reliably: the lines are counted, not read.
  auto lines = TextLines::open(rows->file);
  if (!lines) return fail(lines.error());
  std::string_view line;
  for (;;) {
    const auto more = lines->next(line);
    if (!more) return fail(more.error());
    if (!*more) break;
    if (rows->firstLine == 0 || lines->number() < rows->firstLine || isRemark(line)) continue;
    const bool isCount = dialect() == RowDialect::Pts && trimmed(line).find_first_of(" \t,;") == std::string_view::npos;
    if (!isCount) ++info.pointCount;
  }
  info.attributes = rows->layout.attributes();
  info.details = fmt::format("{} between {}: {}", dialect() == RowDialect::Pts ? "PTS, numbers" : "Text, numbers",
                             separatorName(rows->style.separator), rows->layout.words());
  return info;
}

Result<std::vector<ImportWarning>> RowScanReader::read(const std::string& path, const BatchSink& sink, const Progress& progress) const {
  const auto rows = openRowFile(path, dialect());
  if (!rows) return fail(rows.error());
  auto reader = RowReader::open(*rows);
  if (!reader) return fail(reader.error());
  const std::string what = "Reading " + std::filesystem::path(path).filename().string();
  RowBatch batch(rows->layout);
  NumberRow row;
  std::vector<ImportWarning> warnings = {{fmt::format("The columns were {} as {}", rows->hasHeader ? "named" : "taken", rows->layout.words()), "columns"}};
  for (;;) {
    const auto more = reader->next(row);
    if (!more) return fail(more.error());
    if (*more) batch.add(row.data());
    if (batch.size() >= kBatch || (!*more && batch.size() > 0)) {
      progress.report(reader->fraction(), what);
      if (progress.cancelled()) return fail(cancelledError());
      PointBatch points = batch.take();
      if (!sink(points)) return warnings;
    }
    if (!*more) break;
  }
  if (reader->declaredCount() > 0 && reader->declaredCount() < reader->rowCount())
    warnings.push_back({fmt::format("The file says that it has {} points; it has {}", reader->declaredCount(), reader->rowCount()), "count"});
  if (batch.dropped() > 0)
    warnings.push_back({fmt::format("{} points without usable coordinates were left out", batch.dropped()), "points"});
  progress.report(1.0, what);
  return warnings;
}

ReaderDescription PtsReader::description() const { return {"pts", "PTS point list", {"pts"}}; }

int PtsReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder || probe.extension != "pts") return 0;
  const RowLook look = lookAtRows(headOf(probe));
  return look.rows && look.count ? 80 : 30;
}

ReaderDescription XyzReader::description() const { return {"xyz", "Point list", {"xyz", "asc", "txt", "csv"}}; }

int XyzReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  const bool own = probe.extension == "xyz" || probe.extension == "asc", csv = probe.extension == "csv", text = probe.extension == "txt";
  if (!own && !csv && !text) return 0;
  const RowLook look = lookAtRows(headOf(probe));
  if (!look.rows || look.pixels) return own ? 20 : 0;
  if (own) return 60;
  const auto attributes = look.layout.attributes();
  const bool cloudColumns = std::any_of(attributes.begin(), attributes.end(), [](const std::string& name) {
    return name == "rgb" || name == "intensity" || name == "normal" || name == "classification";
  });
  // Stake-out lists are CSV, too: a header that names what only scans have tells them apart, else names do.
  if (look.named) return cloudColumns ? 70 : 55;
  const bool maybeNumbered = look.columns >= 4 && look.columns <= 6 && attributes != std::vector<std::string>{"rgb"};
  if (look.separator == ' ') return maybeNumbered ? 40 : 45;
  return maybeNumbered ? 25 : 48;
}

}  // namespace alidade
