// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/las_header.h"
#include "survey/point_batch.h"
#include "survey/point_records.h"

namespace alidade {

/// The largest colour number among the records; 0 where the format has no colours.
std::uint16_t largestLasColour(const LasHeader& header, const std::byte* records, std::size_t count);

/// Where the records hold every field, bit for bit. What PointBatch has no place for comes as extra columns:
///
/// - "scan_flags" u8: bits 0-3 synthetic, key point, withheld, overlap; 4-5 scanner channel; 6 scan direction;
///   7 edge of flight line. The older formats' flags are put where the formats 6-10 have them.
/// - "scan_angle_rank" i8, degrees (formats 0-5); "scan_angle" i16, 0.006 degrees (6-10).
/// - "user_data" u8; "nir" u16 (8, 10); "wave_packet" 29 u8 (4, 5, 9, 10).
/// - Every extra byte by its own name (LasHeader::extras); those that no record describes as "extra_bytes" u8.
///
/// Extra bytes named "row", "column" and "scanner" (any case, unscaled integers of up to 32, 32 and 16
/// bits) are left out: they are columns of other types.
RecordFormat lasRecordFormat(const LasHeader& header, bool unshiftedColours);

/// False where a batch has columns that the format does not name: "row", "column", "scanner".
bool lasRecordsTellAll(const LasHeader& header);

/// Fills a batch anew from point records, in the memory that it has: the format's fields, and the columns that it leaves
/// out. Without "scanner", the point source ID gives it where the file names its stations.
void decodeLasPoints(const LasHeader& header, const RecordFormat& format, const std::byte* records, std::size_t count, PointBatch& batch);

/// What decodeLasPoints fills, as ScanInfo::attributes names it.
std::vector<std::string> lasAttributes(const LasHeader& header);

}  // namespace alidade
