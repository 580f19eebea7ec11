// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/row_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

constexpr std::size_t kSampleRows = 1000;
constexpr std::uint64_t kSpots = 16;
constexpr std::size_t kSpotBytes = 8192;

const std::string kAdvice = "Give rows of x y z and further numbers; a first line '# columns: x y z - r g b' says what they mean";

using Sample = std::vector<std::vector<double>>;

/// The columns that a header or a remark names.
std::optional<std::vector<TextColumn>> headerOf(std::string_view line) {
  line = trimmed(line);
  while (line.starts_with('#') || line.starts_with('/')) line.remove_prefix(1);
  line = trimmed(line);
  if (lowerCase(line.substr(0, 8)) == "columns:") line.remove_prefix(8);
  NumberStyle style = styleOf(trimmed(line));
  return columnsNamed(fieldsOf(trimmed(line), style));
}

bool singleCount(std::string_view line, std::uint64_t& count) {
  const auto value = parseInteger(trimmed(line));
  if (!value || *value < 0) return false;
  count = static_cast<std::uint64_t>(*value);
  return true;
}

void addRow(std::string_view line, const NumberStyle& style, std::size_t columns, Sample& sample) {
  NumberRow row;
  std::string_view wrong;
  if (isRemark(line) || parseRow(line, style, row, wrong) != static_cast<int>(columns)) return;
  sample.emplace_back(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(columns));
}

/// Rows from places all over the file: ranges often differ from the first ones'.
Result<void> sampleSpots(const InputFile& file, const NumberStyle& style, std::size_t columns, Sample& sample) {
  std::vector<char> spot(kSpotBytes);
  for (std::uint64_t i = 1; i <= kSpots; ++i) {
    const auto got = file.readSome(file.size() / (kSpots + 1) * i, std::as_writable_bytes(std::span(spot)));
    if (!got) return fail(got.error());
    std::string_view text(spot.data(), *got);
    // Its first and last line are likely cut.
    const auto begin = text.find('\n'), end = text.rfind('\n');
    if (begin == std::string_view::npos || end <= begin) continue;
    LineReader lines(text.substr(begin + 1, end - begin));
    for (std::string_view line; lines.next(line);) addRow(line, style, columns, sample);
  }
  return {};
}

/// PTS has its own order; what else comes is guessed.
std::vector<TextColumn> columnsFor(RowDialect dialect, std::size_t columns, const Sample& sample) {
  using enum TextRole;
  const TextColumn x{X, {}}, y{Y, {}}, z{Z, {}}, i{Intensity, {}}, r{Red, {}}, g{Green, {}}, b{Blue, {}};
  if (dialect == RowDialect::Pts && columns == 6) return {x, y, z, r, g, b};
  if (dialect == RowDialect::Pts && columns == 7) return {x, y, z, i, r, g, b};
  return columnsGuessed(columns, sample);
}

}  // namespace

Result<RowFile> openRowFile(const std::string& path, RowDialect dialect) {
  auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  RowFile rows{std::move(*file), dialect, {}, {}, 0, 0, false};
  auto lines = TextLines::open(rows.file);
  if (!lines) return fail(lines.error());
  std::optional<std::vector<TextColumn>> named;
  std::size_t columns = 0;
  Sample sample;
  std::string_view line, wrong;
  while (sample.size() < kSampleRows) {
    const auto more = lines->next(line);
    if (!more) return fail(more.error());
    if (!*more) break;
    std::uint64_t count = 0;
    if (columns == 0 && isRemark(line)) {
      if (auto header = headerOf(line); header && dialect == RowDialect::Xyz) named = std::move(header);
      continue;
    }
    if (singleCount(line, count)) {
      if (dialect == RowDialect::Pts && rows.firstLine == 0) rows.firstLine = lines->number();
      if (dialect == RowDialect::Xyz && columns == 0 && rows.declared == 0) rows.declared = count;
      continue;
    }
    if (columns == 0) {
      rows.style = styleOf(line);
      NumberRow row;
      const int numbers = parseRow(line, rows.style, row, wrong);
      if (numbers < 3) {
        auto header = dialect == RowDialect::Xyz && !rows.hasHeader ? headerOf(line) : std::nullopt;
        if (!header)
          return fail(numbers < 0 ? fmt::format("{} is no number", quotedWords(wrong)) : std::string("The row has less than three numbers"),
                      lines->place(), kAdvice);
        named = std::move(header);
        rows.hasHeader = true;
        continue;
      }
      columns = static_cast<std::size_t>(numbers);
      if (rows.firstLine == 0) rows.firstLine = lines->number();
    }
    addRow(line, rows.style, columns, sample);
  }
  if (columns == 0) {
    rows.layout.columns = columnsGuessed(3, {});
    return rows;
  }
  if (auto ok = sampleSpots(rows.file, rows.style, columns, sample); !ok) return fail(ok.error());
  // A remark that speaks of x, y and z in passing names no columns; a header must fit.
  if (named && named->size() != columns) {
    if (rows.hasHeader)
      return fail(fmt::format("The header names {} columns, the rows have {}", named->size(), columns), placeInFile(path, rows.firstLine), kAdvice);
    named.reset();
  }
  rows.layout.columns = named ? std::move(*named) : columnsFor(dialect, columns, sample);
  rows.hasHeader = named.has_value();
  learnRanges(rows.layout, sample);
  return rows;
}

Result<RowReader> RowReader::open(const RowFile& rows) {
  auto lines = TextLines::open(rows.file);
  if (!lines) return fail(lines.error());
  std::string_view line;
  while (lines->number() + 1 < rows.firstLine) {
    const auto more = lines->next(line);
    if (!more) return fail(more.error());
    if (!*more) break;
  }
  return RowReader(rows, std::move(*lines));
}

Result<bool> RowReader::next(NumberRow& row) {
  std::string_view line, wrong;
  for (;;) {
    const auto more = m_rows->firstLine == 0 ? Result<bool>(false) : m_lines.next(line);
    if (!more) return fail(more.error());
    if (!*more) {
      if (m_count < m_declared)
        return fail(fmt::format("The file ends after {} of {} points", m_count, m_declared), m_lines.place(), "Copy or export the file again");
      return false;
    }
    const int numbers = parseRow(line, m_rows->style, row, wrong);
    if (numbers == static_cast<int>(m_rows->layout.columns.size())) {
      ++m_count;
      return true;
    }
    if (isRemark(line)) continue;
    std::uint64_t count = 0;
    if (m_rows->dialect == RowDialect::Pts && singleCount(line, count)) {
      if (count > m_rows->file.size())
        return fail(fmt::format("The file promises {} points, more than it has bytes", count), m_lines.place(), "Copy or export the file again");
      m_declared += count;
      continue;
    }
    if (numbers < 0) return fail(fmt::format("{} is no number", quotedWords(wrong)), m_lines.place(), "Mend the line or remove it");
    return fail(fmt::format("The row has {} numbers, those before have {}", numbers, m_rows->layout.columns.size()), m_lines.place(),
                "Mend the line or remove it");
  }
}

RowLook lookAtRows(std::string_view head) {
  RowLook look;
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  if (head.find('\0') != std::string_view::npos) return look;
  // The last line may be cut off.
  const auto lastEnd = head.find_last_of("\r\n");
  if (head.size() >= 4096 && lastEnd != std::string_view::npos) head = head.substr(0, lastEnd);
  LineReader lines(head);
  std::optional<std::vector<TextColumn>> named;
  std::string_view wrong;
  NumberStyle style;
  Sample sample;
  for (std::string_view line; lines.next(line);) {
    std::uint64_t count = 0;
    if (isRemark(line)) {
      if (auto header = headerOf(line); header && look.columns == 0) named = std::move(header);
      continue;
    }
    if (look.columns == 0 && !look.count && singleCount(line, count)) {
      look.count = true;
      continue;
    }
    NumberRow row;
    if (look.columns == 0) style = styleOf(line);
    const int numbers = parseRow(line, style, row, wrong);
    if (numbers < 3) {
      if (look.columns > 0) {
        look.rows = false;
        return look;
      }
      auto header = headerOf(line);
      if (!header || named) return look;
      const auto words = fieldsOf(line, style);
      const auto has = [&](const char* name) {
        return std::any_of(words.begin(), words.end(), [&](std::string_view word) { return lowerCase(word) == name; });
      };
      look.pixels = has("u") && has("v");
      named = std::move(header);
      continue;
    }
    if (look.columns != 0 && static_cast<std::size_t>(numbers) != look.columns) return RowLook{};
    look.columns = static_cast<std::size_t>(numbers);
    look.rows = true;
    look.separator = style.separator;
    addRow(line, style, look.columns, sample);
  }
  look.named = named && named->size() == look.columns;
  if (look.rows) look.layout.columns = look.named ? std::move(*named) : columnsGuessed(look.columns, sample);
  return look;
}

}  // namespace alidade
