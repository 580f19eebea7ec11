// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace alidade {

/// What the numbers of an extra column stand for, as LAS's extra bytes say it (LAS 1.4 R15, table 24): value = scale * number + offset.
struct ColumnMeaning {
  /// Three numbers of eight bytes each, of which a column of fewer components uses the first: u64, i64 or f64, as the column's type is.
  using Triple = std::array<std::uint64_t, 3>;

  std::string column;  ///< ExtraColumn::name
  std::string description;
  /// Which of the following the source gives: bit 0 noData, 1 least, 2 largest, 3 scale, 4 offset.
  std::uint8_t given = 0;
  Triple noData{}, least{}, largest{};
  glm::dvec3 scale{1}, offset{0};

  bool empty() const { return given == 0 && description.empty(); }
  bool sameNumbers(const ColumnMeaning& other) const {
    return (given & 0x19) == (other.given & 0x19) && noData == other.noData && scale == other.scale && offset == other.offset;
  }
  friend bool operator==(const ColumnMeaning&, const ColumnMeaning&) = default;
};

/// What PointBatch::gpsTime counts: seconds of the week, or standard GPS time less 1e9 s.
enum class GpsTimeKind { Unknown, OfWeek, Standard };

/// A record of another's in a LAS file, which is handed on as it is.
struct ForeignRecord {
  std::string user;
  std::uint16_t id = 0;
  std::string description;
  std::vector<std::byte> payload;
  friend bool operator==(const ForeignRecord&, const ForeignRecord&) = default;
};

/// What a scan's file says beside its points and ScanInfo, so that it can be written again.
struct ScanNotes {
  std::vector<ColumnMeaning> columns;  ///< those that are not empty()
  GpsTimeKind gpsTime = GpsTimeKind::Unknown;
  std::vector<ForeignRecord> records;
  bool degrees = false;               ///< x and y are degrees
  std::vector<std::string> warnings;  ///< of the header, with their places; not kept by stores
};

}  // namespace alidade
