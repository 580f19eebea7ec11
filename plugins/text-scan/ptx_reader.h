// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// Leica's PTX: one or more scans, each with its size (columns, then rows), the scanner's position and
/// axes, a 4 × 4 transform (row vectors: world = (x y z 1) · M), then one line for each direction of the
/// grid, column by column: x y z i or x y z i r g b, intensity from 0 to 1. `0 0 0` marks a direction without return: it
/// is left out, the others keep their row and column. Each scan is a station.
///
/// Refused, with the line: a header that is none, a size that the file has no room for, what is no number. A
/// transform that is no rigid motion is applied as it stands, with a warning; the station's attitude is then the nearest one.
class PtxReader : public ScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path, const BatchSink& sink, const Progress& progress) const override;
};

}  // namespace alidade
