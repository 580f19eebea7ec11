// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// Uncompressed LAS 1.0 to 1.4, point formats 0-10 (waveforms of 4, 5, 9 and 10 are passed over).
///
/// Coordinates are `scale * integer + offset` in double. Extra bytes named "row", "column" and
/// "scanner" fill the columns of those names; without "scanner" the point source ID does. Colours
/// are 16 bits a channel in the standard; a file whose colours never exceed 255 stored 8 bits.
///
/// Malformed input: refused where points would be wrong or missing (truncated, counts past the end,
/// impossible scale or record length); repaired with a warning where only a description suffers
/// (bad VLRs, bad bounds, a disagreeing legacy count). LAZ is refused by name.
class LasReader : public ScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path,
                                          const BatchSink& sink,
                                          const Progress& progress) const override;
};

}  // namespace alidade
