// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// ASTM E57 scans (E2807-11): any number of set-ups with their poses, cartesian or spherical, all field
/// codings of the standard. Points come in world coordinates; a set-up is a station and the column `scanner`
/// says which. Fields without a column of their own are kept as extra columns, and so is the raw intensity
/// where it is not 16-bit already.
///
/// Refused: no E57, another major version, a wrong checksum in any page read, broken XML, a section that
/// is none or has no room for its points, packets that do not fit their fields. Tolerated: an offset of 0
/// for a scan without points (with a warning), ranges and bounds that say nothing. Directions without a
/// return (invalid state 1 and 2) are left out and counted.
class E57Reader : public ScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path, const BatchSink& sink, const Progress& progress) const override;
  /// Decodes packets here and there; of the others the first bytes are read.
  Result<void> sample(const std::string& path, std::uint64_t wanted, const BatchSink& sink, const Progress& progress) const override;
};

}  // namespace alidade
