// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// IFC2x3 and IFC4 in STEP files (ISO 10303-21). `inspect` scans the text; `read` has the helper program
/// alidade-ifc-convert make the geometry, because the library behind it crashes on bad files.
///
/// World coordinates: the file's placements in metres, the context's world coordinate system, then
/// IfcMapConversion (or its IFC2x3 stand-in ePSet_MapConversion) where there is one.
class IfcReader : public DesignReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<DesignInfo> inspect(const std::string& path) const override;
  Result<DesignModel> read(const std::string& path, const Progress& progress,
                           std::vector<ImportWarning>& warnings) const override;
};

}  // namespace alidade
