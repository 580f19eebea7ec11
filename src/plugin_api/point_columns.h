// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "survey/number_type.h"
#include "survey/point_batch.h"

namespace alidade {

/// For formats whose points are rows of named columns (PLY, PCD, text): finds out which column is
/// what, and turns rows of numbers into batches.
///
/// Names are compared without case; "red", "r" and "diffuse_red" are one. Colours and intensities
/// come in several ranges and the files do not say which: it is taken from the type and from the
/// largest value of the first batch (colours 0-1, 0-255 or 0-65535; intensities the same). Rows
/// whose coordinates are not finite, or beyond 1e12, are left out and counted.
class PointColumns {
 public:
  struct Column {
    std::string name;
    NumberType type = NumberType::F32;
  };

  /// Error where there is no x, y or z; it names the columns that there are.
  static Result<PointColumns> make(const std::vector<Column>& columns);

  /// Attribute names for ScanInfo.
  std::vector<std::string> attributes() const;

  /// One value per column, in the order given to make(). A packed colour ("rgb", "rgba") is the
  /// number 0x00RRGGBB.
  void addRow(const double* values);
  /// Rows added since the last take().
  std::size_t rowCount() const { return m_rowCount; }
  /// The rows as a batch, valid until the next call; the caller may take its columns away.
  PointBatch& take();
  std::uint64_t droppedCount() const { return m_dropped; }

  /// True for a column that addRow ignores.
  bool ignores(std::size_t column) const;

 private:
  enum Role { X, Y, Z, Red, Green, Blue, Packed, Intensity, Class, Return, Time, Nx, Ny, Nz, Scanner, Row, Col, kRoles };
  static int roleOf(const std::string& lowerCaseName);
  bool has(Role role) const { return m_columnOf[role] >= 0; }
  bool hasRgb() const { return has(Packed) || (has(Red) && has(Green) && has(Blue)); }
  void learnRanges();
  double largest(Role role) const;
  void takeColours();
  void takeNormals();

  std::array<int, kRoles> m_columnOf{};
  std::array<NumberType, kRoles> m_typeOf{};
  std::array<std::vector<double>, kRoles> m_values;
  std::size_t m_rowCount = 0;
  std::uint64_t m_dropped = 0;
  bool m_learned = false;
  double m_colourFactor = 1, m_intensityFactor = 1;
  PointBatch m_batch;
};

}  // namespace alidade
