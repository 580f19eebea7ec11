// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace alidade {

/// How the numbers of a line are written: what parts them, and whether a comma may be the decimal sign. ' '
/// stands for any run of blanks and tabs.
struct NumberStyle {
  char separator = ' ';
  bool decimalComma = false;  ///< points are understood beside commas
  friend bool operator==(const NumberStyle&, const NumberStyle&) = default;
};

constexpr std::size_t kMostColumns = 64;
using NumberRow = std::array<double, kMostColumns>;

/// Splits a line at the style's separator; fields are trimmed of blanks and quotes.
std::vector<std::string_view> fieldsOf(std::string_view line, const NumberStyle& style);

/// One field as a number; false where it is none. An empty field is NaN where the separator is visible.
bool parseField(std::string_view field, const NumberStyle& style, double& value);

/// The numbers of a line. Returns how many there are; -1 where a field is no number (it is then in
/// `wrong`) or there are more than kMostColumns.
int parseRow(std::string_view line, const NumberStyle& style, NumberRow& row, std::string_view& wrong);

/// The style of a data line, by what stands in it. "1,5 2,5 3,5" is blanks with decimal commas, "1,2,3" is commas,
/// "1,5;2,5;3,5" is semicolons with decimal commas.
NumberStyle styleOf(std::string_view line);

/// True for empty lines and remarks (# and //).
bool isRemark(std::string_view line);

}  // namespace alidade
