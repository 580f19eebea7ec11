// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <optional>
#include <string>

#include "plugin_api/reader.h"

namespace alidade {

/// `transforms.json` of Nerfstudio and instant-ngp (Nerfstudio's manual, "Data conventions").
///
/// `transform_matrix` is world from camera with OpenGL's camera axes (x right, y up, z backwards); half a turn about
/// x makes them OpenCV's. cx and cy count from the corner of the top-left pixel and lose half a pixel. Intrinsics
/// stand at the top, in a frame, or both (the frame's go first). Without fl_x the focal length comes from
/// camera_angle_x, without w and h the size from the picture beside the file, without cx and cy the principal point is
/// the middle. `applied_transform` and `applied_scale`, which Nerfstudio put between the survey's coordinates and the
/// file's, are undone, with a warning.
///
/// Refused: models other than pinhole, OpenCV and OpenCV fisheye, by name; k4 of an OpenCV lens, whose place differs
/// between readers; matrices that hold no rotation; non-finite numbers; pictures without a size.
class TransformsReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// Width and height of the picture that a frame's file_path names; nothing where it cannot be found.
using PictureSize = std::function<std::optional<glm::ivec2>(const std::string& filePath)>;

/// The same of a text in memory; `path` is for messages.
Result<CameraSet> parseTransforms(const std::string& text, const std::string& path, const PictureSize& pictureSize);

}  // namespace alidade
