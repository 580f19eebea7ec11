// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "cloud/lattice.h"
#include "cloud/levels.h"
#include "cloud/point_schema.h"
#include "cloud/point_store.h"
#include "survey/point_batch.h"
#include "survey/scan_notes.h"

namespace alidade {

/// One scan of a store: everything but nodes, tables and columns, which stand in files of its folder.
struct PartManifest {
  std::string folder;    ///< "part-0001", in the store's folder
  std::string source;    ///< the scan it was made from
  std::string identity;  ///< ScanSource::identity
  ScanInfo info;         ///< the source's
  ScanNotes notes;       ///< the source's, without its warnings
  Lattice lattice;
  PointSchema schema;
  LevelKind levelKind = LevelKind::BlueNoise;
  LevelLaw law;
  double lawShift = 0;
  std::uint32_t seed = 1;
  std::uint64_t pointCount = 0, dropped = 0;
  std::uint64_t nodeCount = 0, tableCount = 0;
  std::uint64_t nodesChecksum = 0, tablesChecksum = 0;
  std::uint64_t purpose = 0;  ///< checksum of what the part was to be, see indexScans

  /// Bytes a point of a column, by PartSink::Column.
  std::size_t columnWidth(std::size_t column) const;
};

/// "part-0001" for 1.
std::string partFolderName(std::size_t number);

/// manifest.json: JSON {"format", "version", "checksum", "parts"}; the checksum is that of the parts' text as
/// it is written without blanks. Text that is no UTF-8 is an array of its bytes, a number that is not
/// finite is null.
std::string manifestText(const std::vector<PartManifest>& parts);
/// `path` is for messages; parts are numbered from `first`. Every value is of its type and in its range; the counts' products do not overflow.
Result<std::vector<PartManifest>> parseManifest(std::string_view text, const std::string& path, std::size_t first = 1);
/// Reads and parses a manifest file.
Result<std::vector<PartManifest>> readManifest(const std::string& path, std::size_t first = 1);

inline constexpr const char* kManifestName = "manifest.json";
inline constexpr const char* kManifestFormat = "alidade-points";

}  // namespace alidade
