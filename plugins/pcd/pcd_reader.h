// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// PCD point clouds: ascii, binary and binary_compressed. Coordinates of ascii files are read as
/// doubles whatever type the header names, since the text has the digits. A cloud of more than one
/// row gives its points their row and column.
///
/// Malformed input is refused: no header, counts that the file cannot hold, a row with too few
/// numbers, a damaged compressed block. Points without finite coordinates (PCD's mark for "no
/// return") are left out. Commas between numbers are tolerated. The VIEWPOINT is not applied.
class PcdReader : public ScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path,
                                          const BatchSink& sink,
                                          const Progress& progress) const override;
};

}  // namespace alidade
