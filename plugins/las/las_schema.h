// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include "las/las_header.h"
#include "survey/point_batch.h"

namespace alidade {

/// The point record that a file is written with: chosen from the columns of the first batch, then kept.
///
/// - Columns that come from the formats 0-5 ("scan_angle_rank") and nothing that needs more: format 0-5.
/// - All others, and whatever COPC is wanted of: format 6-10.
/// - Every column without a field of its own becomes extra bytes of its name: row, column, scanner, the normal as
///   NormalX, NormalY, NormalZ.
class LasSchema {
 public:
  /// `tree`: COPC, which knows the formats 6, 7 and 8 only. Error where the columns do not fit a record.
  static Result<LasSchema> of(const PointBatch& batch, const ScanInfo& info, const ScanNotes& notes, bool tree, const std::string& path);

  int pointFormat() const { return m_format; }
  std::size_t recordLength() const { return m_recordLength; }
  const glm::dvec3& scale() const { return m_scale; }
  const glm::dvec3& offset() const { return m_offset; }
  /// Columns that got another name, as text.
  const std::vector<std::string>& remarks() const { return m_remarks; }
  /// Payload of the extra bytes record; empty where there are none.
  std::vector<std::byte> extraBytesRecord() const;

  /// What the header sums up.
  struct Totals {
    std::uint64_t count = 0;
    std::array<std::uint64_t, 15> byReturn{};
    glm::ivec3 low{0}, high{0};  ///< scaled integers
    double firstTime = 0, lastTime = 0;  ///< of all GPS times
    double rounding = 0;  ///< metres that a coordinate changed by at most, beyond what doubles differ by
    void add(const Totals& other);
  };

  /// Appends the batch's points to `records` and to `totals`. Error, naming the point, where a number does not fit
  /// its field, or where the batch has a column that the first one had not.
  Result<void> encode(const PointBatch& batch, const std::string& path, std::vector<std::byte>& records,
                      Totals& totals) const;

 private:
  /// The columns of PointBatch's own that are extra bytes, and ExtraColumns, whatever their names: a column is found by what it is.
  enum class Origin { Own, User };
  struct Extra {
    Origin origin;
    std::string column;  ///< what the batch calls it
    int ordinal;         ///< among the batch's ExtraColumns of that name, from 0
    std::string name;    ///< what the file calls it
    NumberType type;
    int components;
    std::uint32_t offset;  ///< in the record
    ColumnMeaning meaning;
    std::size_t size() const { return numberSize(type) * static_cast<std::size_t>(components); }
  };

  bool wide() const { return m_format >= 6; }
  void addOwn(const char* name, NumberType type);
  void addUser(const ExtraColumn& column, int ordinal, const ScanNotes& notes);
  void addExtra(Extra extra);
  const Extra* find(Origin origin, const std::string& column, int ordinal = 0) const;
  Result<void> checkColumns(const PointBatch& batch, const std::string& path) const;
  Result<void> encodePositions(const PointBatch& batch, const std::string& path, std::byte* at, Totals& totals) const;
  Result<void> encodeFields(const PointBatch& batch, const std::string& path, std::byte* at, Totals& totals) const;
  Result<void> encodeExtraColumn(const ExtraColumn& column, int ordinal, std::size_t count, const std::string& path,
                                 std::byte* at) const;

  int m_format = 6;
  std::size_t m_recordLength = 30;
  glm::dvec3 m_scale{0}, m_offset{0};
  std::vector<Extra> m_extras;
  std::vector<std::string> m_remarks;
};

}  // namespace alidade
