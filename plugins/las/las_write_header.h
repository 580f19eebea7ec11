// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/las_schema.h"
#include "plugin_api/scan_writer.h"

namespace alidade {

/// A variable length record to be written, before the points or (extended) behind them.
struct LasRecord {
  std::string user;
  std::uint16_t id = 0;
  std::string description;
  std::vector<std::byte> payload;
};

/// Everything before the first point and behind the last but the points.
struct LasFileFrame {
  int versionMinor = 4;
  bool compressed = false, wkt = false, standardTimes = false;
  std::vector<LasRecord> records;          ///< in this order behind the header
  std::vector<LasRecord> extendedRecords;  ///< behind the points
  std::vector<std::string> remarks;

  static LasFileFrame of(const LasSchema& schema, const ScanWriteOptions& options);
  /// Header and records. Totals and places that are not known yet are patched by writing it again.
  std::vector<std::byte> bytes(const LasSchema& schema, const LasSchema::Totals& totals,
                               std::uint64_t extendedAt) const;
  std::vector<std::byte> extendedBytes() const;
};

}  // namespace alidade
