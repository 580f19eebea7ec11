// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// A COLMAP model: a folder with cameras, images and points3D, each .txt or .bin (COLMAP's manual, "Output
/// format"), or any one of these files, which stands for its folder. A folder with both is read as text.
///
/// COLMAP's pixel origin is the corner of the top-left pixel, so principal points and observations
/// lose half a pixel. Poses are camera from world already. Quaternions are normalised.
///
/// Refused: unknown camera models, by name; non-finite numbers, ids that come twice, cut-off lines
/// and files, each with its line or byte. Tolerated with a warning: images of a camera that is not there, names that
/// come twice, points seen in images or features that are not there, a missing images or
/// points3D, an image without its second line.
class ColmapReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

}  // namespace alidade
