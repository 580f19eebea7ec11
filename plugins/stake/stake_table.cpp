// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "stake/stake_table.h"

#include <algorithm>
#include <initializer_list>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

const std::string kAdvice = "Give a header such as name,E,N,H,code or lines of name,E,N,H";

struct Heading {
  std::string name;  // lower case, letters and digits alone
  std::string unit;  // "mm"; empty where none stands
};

/// "Höhe [m]" -> hoehe, m; "tol_mm" -> tol, mm.
Heading headingOf(std::string_view text) {
  Heading heading;
  std::string lower = lowerCase(text);
  static const std::string kOe = "oe";
  for (const std::string_view umlaut : {"ö", "Ö", "\xf6", "\xd6"})
    for (std::size_t at; (at = lower.find(umlaut)) != std::string::npos;) lower.replace(at, umlaut.size(), kOe);
  if (const std::size_t open = lower.find_first_of("[("); open != std::string::npos) {
    const std::size_t close = lower.find_first_of("])", open);
    heading.unit = std::string(trimmed(std::string_view(lower).substr(open + 1, close == std::string::npos ? close : close - open - 1)));
    lower.erase(open, close == std::string::npos ? close : close - open + 1);
  } else {
    for (const std::string_view unit : {"mm", "cm", "m", "ft"}) {
      if (lower.size() <= unit.size() || !lower.ends_with(unit)) continue;
      if (const char before = lower[lower.size() - unit.size() - 1]; before != '_' && before != ' ') continue;
      heading.unit = std::string(unit);
      lower.resize(lower.size() - unit.size() - 1);
      break;
    }
  }
  for (const char c : lower)
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) heading.name += c;
  return heading;
}

std::optional<StakeColumn> columnNamed(const std::string& name) {
  const auto is = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is({"name", "number", "nr", "no", "num", "id", "point", "pt", "pointid", "pointname", "pointnumber", "pointno", "punkt",
          "punktnr", "punktname", "punktnummer", "pktnr", "pnr", "ptnr", "nummer", "bezeichnung"}))
    return StakeColumn::Name;
  if (is({"e", "east", "easting", "eastings", "x", "ost", "ostwert", "rechtswert", "rechts", "rw"})) return StakeColumn::East;
  if (is({"n", "north", "northing", "northings", "y", "nord", "nordwert", "hochwert", "hoch", "hw"})) return StakeColumn::North;
  if (is({"h", "height", "z", "elev", "elevation", "hoehe", "hohe", "altitude", "alt", "hgt"})) return StakeColumn::Height;
  if (is({"code", "description", "desc", "beschreibung", "bemerkung", "remark", "comment", "kommentar", "type", "typ", "art"}))
    return StakeColumn::Code;
  if (is({"tolerance", "tol", "toleranz"})) return StakeColumn::Tolerance;
  return std::nullopt;
}

std::optional<double> metresOf(const std::string& unit) {
  if (unit.empty() || unit == "m") return 1.0;
  if (unit == "cm") return 0.01;
  if (unit == "mm") return 0.001;
  return std::nullopt;
}

bool isXyz(const std::string& name) { return name == "x" || name == "y" || name == "z"; }

Result<StakeLayout> headerLayout(const std::vector<std::string>& fields) {
  StakeLayout layout;
  layout.hasHeader = true;
  std::array<std::string, kStakeColumns> taken;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Heading heading = headingOf(fields[i]);
    const auto column = columnNamed(heading.name);
    if (!column) continue;
    const auto slot = static_cast<std::size_t>(*column);
    if (layout.index[slot] >= 0) {
      // E beside x: x is something local, E is meant.
      if (isXyz(heading.name) && !isXyz(taken[slot])) continue;
      // Text columns: the first one counts ("id" and "name").
      if (*column == StakeColumn::Name || *column == StakeColumn::Code) continue;
      if (!isXyz(taken[slot]))
        return fail("Two columns mean the same: " + quotedWords(taken[slot]) + " and " + quotedWords(fields[i]), {}, "Rename one of them");
    }
    const auto metres = metresOf(heading.unit);
    const bool isText = *column == StakeColumn::Name || *column == StakeColumn::Code;
    if (!metres && !isText)
      return fail("The unit " + quotedWords(heading.unit) + " of the column " + quotedWords(fields[i]) + " is not read", {},
                  "Give metres, centimetres or millimetres");
    layout.index[slot] = static_cast<int>(i);
    layout.toMetres[slot] = metres.value_or(1.0);
    taken[slot] = heading.name;
  }
  for (const auto& [column, word] : {std::pair{StakeColumn::East, "E"}, {StakeColumn::North, "N"}, {StakeColumn::Height, "H"}})
    if (layout.at(column) < 0) return fail(std::string("The header names no column ") + word, {}, kAdvice);
  layout.usesXy = taken[static_cast<std::size_t>(StakeColumn::East)] == "x" &&
                  taken[static_cast<std::size_t>(StakeColumn::North)] == "y";
  return layout;
}

}  // namespace

char separatorOf(std::string_view line) {
  bool quotes = false;
  bool comma = false, semicolon = false;
  for (const char c : line) {
    if (c == '"') quotes = !quotes;
    if (quotes) continue;
    if (c == '\t') return '\t';
    semicolon = semicolon || c == ';';
    comma = comma || c == ',';
  }
  return semicolon ? ';' : comma ? ',' : ' ';
}

std::optional<std::vector<std::string>> splitFields(std::string_view line, char separator) {
  std::vector<std::string> fields;
  std::size_t at = 0;
  const auto skipBlanks = [&] {
    while (at < line.size() && (line[at] == ' ' || (line[at] == '\t' && separator != '\t'))) ++at;
  };
  while (true) {
    skipBlanks();
    if (separator == ' ' && at >= line.size()) return fields;
    std::string field;
    if (at < line.size() && line[at] == '"') {
      for (++at;; ++at) {
        if (at >= line.size()) return std::nullopt;
        if (line[at] == '"') {
          if (at + 1 < line.size() && line[at + 1] == '"') ++at;
          else break;
        }
        field += line[at];
      }
      ++at;
    }
    const std::size_t end = std::min(line.find(separator, at), line.size());
    field += trimmed(line.substr(at, end - at));
    fields.push_back(std::move(field));
    if (end >= line.size()) return fields;
    at = end + 1;
  }
}

std::optional<double> surveyNumber(std::string_view text, char separator) {
  std::string plain;
  for (const char c : trimmed(text))
    if (c != '\'') plain += c;
  if (separator != ',' && std::count(plain.begin(), plain.end(), ',') == 1 && plain.find('.') == std::string::npos)
    std::replace(plain.begin(), plain.end(), ',', '.');
  return parseNumber(plain);
}

Result<StakeLayout> layoutOf(const std::vector<std::string>& firstLine, char separator) {
  const auto isNumber = [&](std::size_t i) { return i < firstLine.size() && surveyNumber(firstLine[i], separator).has_value(); };
  if (isNumber(1) && isNumber(2) && isNumber(3)) {
    StakeLayout layout;
    layout.index = {0, 1, 2, 3, firstLine.size() > 4 ? 4 : -1, -1};
    return layout;
  }
  const bool anyNumber = std::any_of(firstLine.begin(), firstLine.end(),
                                     [&](const std::string& field) { return surveyNumber(field, separator).has_value(); });
  if (anyNumber || firstLine.size() < 3)
    return fail("The first line is neither a header nor name, E, N, H", {}, kAdvice);
  return headerLayout(firstLine);
}

}  // namespace alidade
