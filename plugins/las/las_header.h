// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/bounds.h"
#include "las/byte_source.h"
#include "las/copc_info.h"
#include "las/laz_layout.h"
#include "plugin_api/reader.h"
#include "survey/scan_notes.h"

namespace alidade {

static_assert(std::endian::native == std::endian::little, "LAS is little endian and so is this reader");

/// A number at an offset of a record; the caller knows that the record is long enough.
template <class T>
T lasValue(const std::byte* record, std::size_t offset) {
  T value;
  std::memcpy(&value, record + offset, sizeof(T));
  return value;
}

/// One entry of the extra bytes VLR (LAS 1.4 R15, table 24): a column appended to the point record.
struct LasExtraBytes {
  std::string name;
  int type = 0;            ///< 1..10: u8 i8 u16 i16 u32 i32 u64 i64 f32 f64; 0: undocumented
  int components = 1;      ///< numbers of that type
  std::uint32_t offset = 0;  ///< within the point record, bytes
  std::uint32_t size = 0;    ///< bytes
  bool scaled = false;     ///< has a scale or an offset of its own
  ColumnMeaning meaning;   ///< of the column of this name
};

/// A scanner's set-up as our own record gives it (las_stations.h).
struct LasStation {
  Station station;
  std::uint16_t pointSource = 0;  ///< of its points
};

/// All that is known of a LAS file before its points are read.
struct LasHeader {
  int versionMajor = 1, versionMinor = 0;
  std::uint16_t globalEncoding = 0;
  std::string systemId, generator;
  std::uint16_t creationDay = 0, creationYear = 0;  ///< day of the year from 1
  std::uint16_t headerSize = 0;
  std::uint64_t pointsOffset = 0;
  std::uint32_t vlrCount = 0;
  int pointFormat = 0;
  std::uint16_t recordLength = 0;
  std::uint64_t pointCount = 0;
  glm::dvec3 scale{0}, offset{0};
  Bounds bounds;  ///< empty where the header's are no bounds
  std::uint64_t evlrOffset = 0;
  std::uint32_t evlrCount = 0;
  std::optional<LazLayout> laz;  ///< where the points are compressed
  std::optional<CopcInfo> copc;  ///< where the chunks are the nodes of an octree

  std::string crs;          ///< WKT, "EPSG:n", "EPSG:n+m" (m: the heights) or empty
  std::string crsNote;      ///< vertical system and the like, for `details`
  bool degrees = false;     ///< x and y
  std::vector<LasExtraBytes> extras;  ///< their names are no field's and each another's; where the file's were not, with a warning
  std::vector<ForeignRecord> foreignRecords;
  std::vector<LasStation> stations;
  std::vector<ImportWarning> warnings;

  bool hasGpsTime() const;
  bool hasRgb() const;
  bool hasWaveforms() const;
  bool hasNir() const;
  /// Bytes into the record where red, green and blue stand; valid where hasRgb().
  std::uint32_t rgbOffset() const;
  /// Bytes into the record where the GPS time stands; valid where hasGpsTime().
  std::uint32_t gpsTimeOffset() const;
  /// Bytes into the record where the wave packet stands; valid where hasWaveforms().
  std::uint32_t wavePacketOffset() const;
  const LasExtraBytes* extra(const std::string& lowerCaseName) const;
  std::string details() const;
  ScanNotes notes() const;
};

/// Bytes of a point record of this format without extra bytes; 0 for a format that is unknown.
std::uint16_t lasRecordLength(int pointFormat);

/// Reads header, VLRs and EVLRs and checks them against the file's size.
Result<LasHeader> readLasHeader(const ByteSource& file);

}  // namespace alidade
