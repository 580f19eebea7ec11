// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "stake/stake_point_reader.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "plugin_api/text_file.h"
#include "stake/stake_table.h"

namespace alidade {

namespace {

constexpr double kFarthestM = 1e9;
constexpr std::size_t kMaxWarnings = 20;

bool isRemark(std::string_view words) { return words.starts_with('#') || words.starts_with("//"); }

bool isUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto c = static_cast<unsigned char>(text[i]);
    const std::size_t more = c < 0x80 ? 0 : c >= 0xc2 && c < 0xe0 ? 1 : c >= 0xe0 && c < 0xf0 ? 2 : c >= 0xf0 && c < 0xf5 ? 3 : 4;
    if (more == 4 || i + more >= text.size()) return false;
    for (std::size_t k = 1; k <= more; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return false;
    i += more + 1;
  }
  return true;
}

std::string utf8FromLatin1(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const auto b = static_cast<unsigned char>(c);
    if (b >= 0x80) {
      out += static_cast<char>(0xc0 | b >> 6);
      out += static_cast<char>(0x80 | (b & 0x3f));
    } else {
      out += c;
    }
  }
  return out;
}

/// Text of a column; empty where the line has none.
std::string textAt(const std::vector<std::string>& fields, int index) {
  return index >= 0 && index < static_cast<int>(fields.size()) ? fields[static_cast<std::size_t>(index)] : std::string();
}

Result<double> lengthAt(const std::vector<std::string>& fields, const StakeLayout& layout, StakeColumn column,
                        const char* word, char separator) {
  const std::string text = textAt(fields, layout.at(column));
  if (text.empty()) return fail(std::string("The ") + word + " is missing", {}, "Fill it in or remove the line");
  const auto number = surveyNumber(text, separator);
  if (!number) return fail(std::string("The ") + word + " " + quotedWords(text) + " is no number", {}, "Mend it or remove the line");
  const double metres = *number * layout.factor(column);
  if (!std::isfinite(metres) || std::abs(metres) > kFarthestM)
    return fail(std::string("The ") + word + " " + quotedWords(text) + " is not finite or beyond 1e9 m", {}, "Mend it or remove the line");
  return metres;
}

Result<StakePoint> pointOf(const std::vector<std::string>& fields, const StakeLayout& layout, char separator) {
  StakePoint point;
  point.name = textAt(fields, layout.at(StakeColumn::Name));
  point.code = textAt(fields, layout.at(StakeColumn::Code));
  const std::pair<StakeColumn, const char*> axes[] = {
      {StakeColumn::East, "east coordinate"}, {StakeColumn::North, "north coordinate"}, {StakeColumn::Height, "height"}};
  for (int i = 0; i < 3; ++i) {
    const auto length = lengthAt(fields, layout, axes[i].first, axes[i].second, separator);
    if (!length) return fail(length.error());
    point.position[i] = *length;
  }
  if (!textAt(fields, layout.at(StakeColumn::Tolerance)).empty()) {
    const auto tolerance = lengthAt(fields, layout, StakeColumn::Tolerance, "tolerance", separator);
    if (!tolerance) return fail(tolerance.error());
    if (*tolerance < 0) return fail("The tolerance is negative", {}, "Give a length in metres");
    point.toleranceM = *tolerance;
  }
  return point;
}

/// Collects warnings; the first of a sort in full, then a count.
class Notes {
 public:
  explicit Notes(PointList& list) : m_list(list) {}
  void add(const std::string& what, const std::string& place) {
    if (++m_count <= kMaxWarnings) m_list.warnings.push_back({what, place});
  }
  void finish(const std::string& path) {
    if (m_count > kMaxWarnings) m_list.warnings.push_back({fmt::format("{} more warnings", m_count - kMaxWarnings), path});
  }

 private:
  PointList& m_list;
  std::size_t m_count = 0;
};

}  // namespace

Result<PointList> parseStakePoints(std::string_view text, const std::string& path) {
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    return fail("The file is UTF-16 text", path, "Save it as CSV (UTF-8)");
  if (text.find('\0') != std::string_view::npos) return fail("The file is no text", path, "Save the points as CSV");
  PointList list;
  Notes notes(list);
  std::string converted;
  if (!isUtf8(text)) {
    converted = utf8FromLatin1(text);
    text = converted;
    notes.add("The file is not UTF-8; its letters were read as Latin-1", path);
  }
  std::optional<StakeLayout> layout;
  char separator = ',';
  std::set<std::string> names;
  LineReader lines(text);
  for (std::string_view line; lines.next(line);) {
    const std::string_view words = trimmed(line);
    if (words.empty() || isRemark(words)) continue;
    const std::string place = placeInFile(path, lines.number());
    if (!layout) separator = separatorOf(line);
    // A leading or trailing tab is an empty field, blanks are nothing.
    const auto fields = splitFields(separator == '\t' ? line : words, separator);
    if (!fields) return fail("A quote is opened and never closed", place, "Close it on the same line");
    if (std::all_of(fields->begin(), fields->end(), [](const std::string& f) { return f.empty(); })) continue;
    if (!layout) {
      const auto found = layoutOf(*fields, separator);
      if (!found) return fail(found.error().in(place));
      layout = *found;
      if (layout->usesXy)
        notes.add("x is read as east and y as north; some surveyors' systems mean the opposite: head the columns E and N", place);
      if (layout->at(StakeColumn::Name) < 0) notes.add("The header names no column for names: points are numbered", place);
      if (layout->hasHeader) continue;
    }
    auto point = pointOf(*fields, *layout, separator);
    if (!point) return fail(point.error().in(place));
    if (point->name.empty()) point->name = std::to_string(list.points.size() + 1);
    if (!names.insert(point->name).second) notes.add("The name " + quotedWords(point->name) + " comes twice", place);
    list.points.push_back(std::move(*point));
  }
  if (list.points.empty()) return fail("The file holds no point", path, "Give a header and one line a point");
  notes.finish(path);
  return list;
}

ReaderDescription StakePointReader::description() const { return {"stake", "Points as CSV", {"csv", "txt"}}; }

int StakePointReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  const bool csv = probe.extension == "csv", text = probe.extension == "txt";
  if (!csv && !text) return 0;
  std::string_view head(reinterpret_cast<const char*>(probe.head.data()), probe.head.size());
  if (head.starts_with("\xef\xbb\xbf")) head.remove_prefix(3);
  if (head.find('\0') != std::string_view::npos) return csv ? 10 : 0;
  LineReader lines(head);
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() || isRemark(trimmed(line))) continue;
    const char separator = separatorOf(line);
    const auto fields = splitFields(trimmed(line), separator);
    if (!fields) break;
    const auto layout = layoutOf(*fields, separator);
    if (!layout) break;
    if (layout->hasHeader) {
      // u and v beside E, N, H are observations in a picture.
      const auto has = [&](const char* name) {
        return std::any_of(fields->begin(), fields->end(), [&](const std::string& f) { return lowerCase(f) == name; });
      };
      return has("u") && has("v") ? 0 : 65;
    }
    // Four to six fields; numbers between blanks alone are more likely a cloud or a trajectory.
    const bool nameIsNumber = surveyNumber(fields->front(), separator).has_value();
    if (fields->size() > 6 || (separator == ' ' && nameIsNumber)) break;
    return csv ? 45 : 30;
  }
  return csv ? 15 : 0;
}

Result<PointList> StakePointReader::read(const std::string& path) const {
  const auto text = readTextFile(path);
  if (!text) return fail(text.error());
  return parseStakePoints(*text, path);
}

}  // namespace alidade
