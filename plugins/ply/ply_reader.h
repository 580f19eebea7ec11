// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// The vertices of a PLY file (ascii, binary of either byte order) as a scan. Faces and other
/// elements are passed over; a file with faces is also a mesh, which another reader reads.
///
/// Malformed input is refused: a header that is not understood, counts that the file cannot hold, a
/// row with too few numbers. Points without finite coordinates are left out with a warning.
class PlyReader : public ScanReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<ScanInfo> inspect(const std::string& path) const override;
  Result<std::vector<ImportWarning>> read(const std::string& path,
                                          const BatchSink& sink,
                                          const Progress& progress) const override;
};

}  // namespace alidade
