// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// COLMAP's text model: a folder with cameras.txt, images.txt and points3D.txt (COLMAP's manual,
/// "Output format"), or any one of the three files, which stands for its folder.
///
/// COLMAP's pixel origin is the corner of the top-left pixel, so principal points and observations
/// lose half a pixel. Poses are camera from world already. Quaternions are normalised.
///
/// Refused: unknown camera models, by name; non-finite numbers, ids that come twice, cut-off lines,
/// each with its line. Tolerated with a warning: images of a camera that is not there, names that
/// come twice, points seen in images or features that are not there, a missing images.txt or
/// points3D.txt, an image without its second line.
class ColmapReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

}  // namespace alidade
