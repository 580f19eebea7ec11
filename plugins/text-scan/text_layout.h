// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "survey/point_batch.h"
#include "text-scan/number_row.h"

namespace alidade {

enum class TextRole { X, Y, Z, Intensity, Red, Green, Blue, Nx, Ny, Nz, Class, Return, ReturnCount, Time, Source, Extra, Skip };

struct TextColumn {
  TextRole role = TextRole::Extra;
  std::string name;  ///< of an Extra column
};

/// What each column of a list of points means, and the ranges that its colours and intensities come in.
struct TextLayout {
  std::vector<TextColumn> columns;
  double colourMax = 255;                         ///< 1, 255 or 65535 is full brightness
  double intensityMin = 0, intensityMax = 65535;  ///< becomes 0..65535
  bool keepsIntensity = false;                    ///< as an extra column, too, as it stands

  int columnOf(TextRole role) const;  ///< -1 where there is none
  bool has(TextRole role) const { return columnOf(role) >= 0; }
  std::vector<std::string> attributes() const;
  /// "x y z intensity (0 to 255) red green blue (0 to 255)", for the user to check.
  std::string words() const;
};

/// The columns that a header's words name; nothing where they name no x, y and z. "-" and "skip" leave a column
/// out; unknown words become extra columns.
std::optional<std::vector<TextColumn>> columnsNamed(const std::vector<std::string_view>& words);

/// The columns of rows without a header, from their count and the ranges in `sample`: x y z, then from
/// left to right a colour, a unit normal, an intensity, and extra columns.
std::vector<TextColumn> columnsGuessed(std::size_t columns, const std::vector<std::vector<double>>& sample);

/// Sets the ranges of colours and intensities from the sample.
void learnRanges(TextLayout& layout, const std::vector<std::vector<double>>& sample);

/// Gathers rows and makes batches of them. Rows whose coordinates are not finite or beyond 1e12 are left out and
/// counted.
class RowBatch {
 public:
  explicit RowBatch(TextLayout layout);

  void add(const double* row);
  std::size_t size() const { return m_size; }
  std::uint64_t dropped() const { return m_dropped; }
  /// The rows as a batch; empties it.
  PointBatch take();

 private:
  const std::vector<double>* column(TextRole role) const;
  void takeColours(PointBatch& batch) const;
  void takeIntensity(PointBatch& batch) const;
  void takeNormals(PointBatch& batch) const;

  TextLayout m_layout;
  std::size_t m_x, m_y, m_z;
  std::vector<std::vector<double>> m_values;  ///< by column
  std::size_t m_size = 0;
  std::uint64_t m_dropped = 0;
};

}  // namespace alidade
