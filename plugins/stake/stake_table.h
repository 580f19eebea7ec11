// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace alidade {

enum class StakeColumn { Name, East, North, Height, Code, Tolerance };
inline constexpr std::size_t kStakeColumns = 6;

/// Where each column stands in a line (-1: nowhere) and what its numbers are multiplied with.
struct StakeLayout {
  std::array<int, kStakeColumns> index{-1, -1, -1, -1, -1, -1};
  std::array<double, kStakeColumns> toMetres{1, 1, 1, 1, 1, 1};
  bool hasHeader = false;
  bool usesXy = false;  ///< east and north are headed x and y

  int at(StakeColumn column) const { return index[static_cast<std::size_t>(column)]; }
  double factor(StakeColumn column) const { return toMetres[static_cast<std::size_t>(column)]; }
};

/// ',', ';', '\t', or ' ' for any run of blanks: what stands in the line outside quotes.
char separatorOf(std::string_view line);

/// Splits at the separator and takes quotes off; nothing where a quote is never closed.
std::optional<std::vector<std::string>> splitFields(std::string_view line, char separator);

/// The layout that the first line gives. Error where it is neither a header with E, N and H nor
/// name, E, N, H; its `where` is left empty.
Result<StakeLayout> layoutOf(const std::vector<std::string>& firstLine, char separator);

/// A number as surveyors write it: decimal comma where the comma separates no fields, ' in thousands.
std::optional<double> surveyNumber(std::string_view text, char separator);

}  // namespace alidade
