// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "e57/e57_document.h"
#include "e57/record_reader.h"
#include "survey/point_batch.h"

namespace alidade {

/// Turns a scan's records into batches in world coordinates: finds out which field is what, drops
/// directions without a return, applies the pose, and keeps every further number as an extra column.
class BatchMaker {
 public:
  /// Error where a scan with points has neither cartesian nor spherical coordinates.
  static Result<BatchMaker> make(const E57Scan& scan, std::uint16_t scanner, std::uint16_t rgbWhite);

  /// The columns that make() will fill, for ScanInfo::attributes.
  std::vector<std::string> attributes() const;
  bool hasGrid() const { return has(Row) && has(Column); }
  /// Size of the scanner's grid; 0 where the file does not state it.
  std::uint32_t gridSize(bool rows) const;
  /// Field of the coordinate x, y or z where they are cartesian; null for spherical ones.
  const E57Field* cartesian(int axis) const;

  /// `count` records; consumes the columns. The batch holds those with a return.
  void fill(RecordColumns& columns, std::size_t count, PointBatch& batch);

  std::uint64_t withoutReturn() const { return m_withoutReturn; }  ///< marked invalid by the file
  std::uint64_t unusable() const { return m_unusable; }            ///< not finite or beyond 1e12 m

  /// True where the scan's colours are finer than 8 bits.
  static bool hasDeepColour(const E57Scan& scan);

 private:
  enum Role { X, Y, Z, Invalid, Intensity, Red, Green, Blue, Row, Column, ReturnIndex, ReturnCount, Time, Nx, Ny, Nz, Class, Source, kRoles };

  BatchMaker(const E57Scan& scan, std::uint16_t scanner, std::uint16_t rgbWhite);
  bool has(Role role) const { return m_fieldOf[role] >= 0; }
  const E57Field& field(Role role) const { return m_scan->fields[static_cast<std::size_t>(m_fieldOf[role])]; }
  bool keepsRawIntensity() const;
  E57Limits intensityRange() const;
  E57Limits colourRange(int channel) const;
  std::size_t dropInvalid(RecordColumns& columns, std::size_t count);
  void fillPositions(const RecordColumns& columns, std::size_t count, PointBatch& batch) const;
  void fillColours(const RecordColumns& columns, std::size_t count, PointBatch& batch) const;
  void fillNormals(const RecordColumns& columns, std::size_t count, PointBatch& batch) const;
  void fillExtra(const RecordColumns& columns, std::size_t count, PointBatch& batch) const;

  const E57Scan* m_scan;
  std::uint16_t m_scanner, m_white;
  bool m_spherical = false;
  std::array<int, kRoles> m_fieldOf{};
  std::vector<int> m_extra;  ///< fields
  std::uint64_t m_withoutReturn = 0, m_unusable = 0;
};

}  // namespace alidade
