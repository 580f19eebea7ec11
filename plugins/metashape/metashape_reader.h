// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "plugin_api/reader.h"

namespace alidade {

/// Cameras that Agisoft Metashape (PhotoScan) exports as XML: `<document><chunk>` with sensors,
/// components and cameras.
///
/// Lens (Metashape's manual, "Camera models", frame cameras):
///     u = w/2 + cx + x' f + x' b1 + y' b2,  v = h/2 + cy + y' f,
/// pixels from the corner of the top-left pixel; x' has p1 (r² + 2x²) + 2 p2 xy and y' p2 (r² + 2y²) + 2 p1 xy, so
/// that OpenCV's p1 and p2 are Metashape's p2 and p1. A fisheye is OpenCV's as long as it has no p and no b2.
/// Axes are OpenCV's. A sensor's adjusted calibration goes before its initial one.
///
/// Pose: pInWorld = s R pInChunk + t with the transform of the camera's component, or of the chunk where the
/// component has none and is the active one.
///
/// Refused: chunks georeferenced by anything but a local system, where the transform leads to earth-centred
/// coordinates. Named in the warnings and left out: cameras without transform, disabled ones, those of sensors
/// whose lens no camera model covers (spherical, cylindrical, RPC; films). A chunk without transform is read in its
/// own arbitrary units, with a warning. Of several chunks the first one that holds posed cameras is read.
class MetashapeReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The same of a text in memory; `path` is for messages.
Result<CameraSet> parseMetashape(const std::string& text, const std::string& path, const Progress& progress);

}  // namespace alidade
