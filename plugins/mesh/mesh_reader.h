// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// OBJ, STL, glTF 2.0 (.gltf, .glb) and PLY with faces, read by assimp in the helper program
/// alidade-mesh-convert. assimp keeps coordinates as float: what the file states in double (OBJ, ASCII STL,
/// glTF's node transforms, PLY) is moved near zero by whole metres before assimp sees it, and moved back
/// in double. glTF is y-up and becomes z-up; the others are taken as they are, in metres.
class MeshReader : public DesignReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<DesignInfo> inspect(const std::string& path) const override;
  Result<DesignModel> read(const std::string& path, const Progress& progress,
                           std::vector<ImportWarning>& warnings) const override;
};

}  // namespace alidade
