// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "text-scan/number_row.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "plugin_api/text_file.h"

namespace alidade {

namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Calls `each(field)` for the fields of the line until it returns false.
template <class F>
void forFields(std::string_view line, char separator, F&& each) {
  const char* at = line.data();
  const char* const end = at + line.size();
  if (separator == ' ') {
    for (;;) {
      while (at != end && isBlank(*at)) ++at;
      if (at == end) return;
      const char* from = at;
      while (at != end && !isBlank(*at)) ++at;
      if (!each(std::string_view(from, static_cast<std::size_t>(at - from)))) return;
    }
  }
  for (;;) {
    const char* stop = std::find(at, end, separator);
    const char *from = at, *to = stop;
    while (from != to && (isBlank(*from) || *from == '"')) ++from;
    while (to != from && (isBlank(to[-1]) || to[-1] == '"')) --to;
    if (stop == end && from == to && at != line.data()) return;  // a separator at the line's end ends the last field
    if (!each(std::string_view(from, static_cast<std::size_t>(to - from)))) return;
    if (stop == end) return;
    at = stop + 1;
  }
}

std::ptrdiff_t count(std::string_view text, char c) { return std::count(text.begin(), text.end(), c); }

}  // namespace

std::vector<std::string_view> fieldsOf(std::string_view line, const NumberStyle& style) {
  std::vector<std::string_view> fields;
  forFields(line, style.separator, [&](std::string_view field) {
    fields.push_back(field);
    return fields.size() <= kMostColumns;
  });
  return fields;
}

bool parseField(std::string_view field, const NumberStyle& style, double& value) {
  if (field.empty()) {
    value = std::numeric_limits<double>::quiet_NaN();
    return style.separator != ' ';
  }
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end == field.data() + field.size() && error == std::errc()) return true;
  std::string text(field.substr(0, 64));
  if (style.decimalComma && count(text, ',') == 1 && count(text, '.') == 0) std::replace(text.begin(), text.end(), ',', '.');
  const auto number = field.size() <= 64 ? parseNumber(text) : std::nullopt;
  value = number.value_or(0);
  return number.has_value();
}

int parseRow(std::string_view line, const NumberStyle& style, NumberRow& row, std::string_view& wrong) {
  int columns = 0;
  forFields(line, style.separator, [&](std::string_view field) {
    if (static_cast<std::size_t>(columns) < kMostColumns && parseField(field, style, row[static_cast<std::size_t>(columns)])) {
      ++columns;
      return true;
    }
    wrong = field;
    columns = -1;
    return false;
  });
  return columns;
}

NumberStyle styleOf(std::string_view line) {
  if (count(line, ';') > 0) return {';', true};
  if (count(line, '\t') > 0) return {count(line, ' ') > 0 ? ' ' : '\t', true};
  if (count(line, ',') == 0) return {' ', false};
  // Fields between blanks that hold a comma each, inside: decimal commas.
  bool decimal = true;
  std::size_t fields = 0;
  forFields(line, ' ', [&](std::string_view field) {
    ++fields;
    decimal = decimal && count(field, ',') <= 1 && field.back() != ',' && field.front() != ',' && count(field, '.') == 0;
    return true;
  });
  return decimal && fields >= 3 ? NumberStyle{' ', true} : NumberStyle{',', false};
}

bool isRemark(std::string_view line) {
  const std::string_view words = trimmed(line);
  return words.empty() || words.starts_with('#') || words.starts_with("//");
}

}  // namespace alidade
