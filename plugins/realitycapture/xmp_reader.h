// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>

#include "plugin_api/reader.h"

namespace alidade {

/// The XMP sidecars that RealityCapture (RealityScan) writes beside pictures: a folder of them, or one
/// (Capturing Reality, "RealityCapture XMP Camera Math").
///
/// xcr:Rotation is camera from world, row by row, with OpenCV's axes; xcr:Position the camera's centre. With s the
/// longer side of the picture in pixels: f = FocalLength35mm / 36 s, fy = f AspectRatio, the principal point is
/// PrincipalPointU s, V s from the picture's middle. Brown lenses are OpenCV's radial factor, k1 to k4. The picture's
/// size comes from the picture beside the sidecar.
///
/// Poses whose lens cannot be said exactly come without a camera, with a warning that says why: no picture beside
/// it, tangential coefficients (their order differs between the programs that write them), skew, a division model,
/// models unknown. Named and left out: sidecars without pose. Refused: geographic or earth-centred coordinates, broken numbers.
class XmpReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// One sidecar.
struct XmpCamera {
  std::optional<RigidTransform> cameraFromWorld;
  std::optional<Intrinsics> intrinsics;
  std::string noIntrinsics;  ///< why there are none
  bool relative = false;     ///< coordinates of the component's own, not of the world
};

/// Of a text in memory; `size` is the picture's, `path` for messages.
Result<XmpCamera> parseXmp(const std::string& text, const std::string& path, std::optional<glm::ivec2> size);

}  // namespace alidade
