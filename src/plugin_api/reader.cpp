// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "plugin_api/reader.h"

#include <algorithm>
#include <string_view>

#include "survey/scan_notes.h"

namespace alidade {

namespace {

std::string_view textOf(const FileProbe& probe) {
  return {reinterpret_cast<const char*>(probe.head.data()), probe.head.size()};
}

}  // namespace

Result<ScanNotes> ScanReader::notes(const std::string&) const {
  return ScanNotes{};
}

Result<std::vector<ImportWarning>> ScanReader::readAnyOrder(const std::string& path, const NumberedSink& sink,
                                                            const Progress& progress) const {
  return read(path, [&sink, number = std::uint64_t{0}](PointBatch& batch) mutable { return sink(number++, batch); }, progress);
}

Result<std::optional<std::vector<ImportWarning>>> ScanReader::readRecords(const std::string&, const RecordSink&,
                                                                          const Progress&) const {
  return std::nullopt;
}

Result<void> ScanReader::sample(const std::string& path, std::uint64_t wanted, const BatchSink& sink,
                                const Progress& progress) const {
  const auto info = inspect(path);
  if (!info) return fail(info.error());
  const std::uint64_t step = std::max<std::uint64_t>(1, info->pointCount / std::max<std::uint64_t>(1, wanted));
  std::uint64_t next = 0, seen = 0;  // places in the file
  const auto outcome = read(
      path,
      [&](PointBatch& batch) {
        PointBatch some = batch.every(next - seen, step);
        next += some.size() * step;
        seen += batch.size();
        return some.size() == 0 || sink(some);
      },
      progress);
  if (!outcome) return fail(outcome.error());
  return {};
}

bool FileProbe::startsWith(std::string_view text) const {
  return textOf(*this).starts_with(text);
}

bool FileProbe::holds(std::string_view text) const {
  return textOf(*this).find(text) != std::string_view::npos;
}

}  // namespace alidade
