// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/input_file.h"
#include "plugin_api/reader.h"
#include "text-scan/number_row.h"
#include "text-scan/text_layout.h"
#include "text-scan/text_lines.h"

namespace alidade {

/// Pts: lines of a single whole number are counts of the points that follow. Xyz: a header or a remark may
/// name the columns, and a single number on the first line is a count.
enum class RowDialect { Pts, Xyz };

/// A list of points, understood from its first lines and some further ones taken all over the file.
struct RowFile {
  InputFile file;
  RowDialect dialect;
  NumberStyle style;
  TextLayout layout;
  std::uint64_t firstLine = 0;  ///< number of the first line of points (or of a Pts count); 0 where there is none
  std::uint64_t declared = 0;   ///< what a count on the first line of an Xyz file says; 0 where there is none
  bool hasHeader = false;
};

/// Error where the first line that is no remark is neither a row of at least three numbers nor a header with x, y and z,
/// and where the header names another number of columns than the rows have.
Result<RowFile> openRowFile(const std::string& path, RowDialect dialect);

/// The rows of points: text without remarks, of the count that the layout names. Error, with the line, for what is no
/// number and for a row of another length.
class RowReader {
 public:
  static Result<RowReader> open(const RowFile& rows);
  RowReader(RowReader&&) = default;

  /// The next row; false at the end. `declared` counts are checked: a file that ends before is cut off.
  Result<bool> next(NumberRow& row);
  double fraction() const { return m_lines.fraction(); }
  std::uint64_t rowCount() const { return m_count; }
  std::uint64_t declaredCount() const { return m_declared; }

 private:
  RowReader(const RowFile& rows, TextLines lines) : m_rows(&rows), m_lines(std::move(lines)), m_declared(rows.declared) {}

  const RowFile* m_rows;
  TextLines m_lines;
  std::uint64_t m_count = 0, m_declared = 0;
};

/// For sniffing: what the start of a text looks like.
struct RowLook {
  bool rows = false;        ///< rows of at least three numbers
  bool count = false;       ///< before them a line with a single whole number
  bool named = false;       ///< a header or remark names the columns
  bool pixels = false;      ///< the header names u and v: observations in a picture
  std::size_t columns = 0;
  char separator = ' ';
  TextLayout layout;
};
RowLook lookAtRows(std::string_view head);

}  // namespace alidade
