// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// The pinhole cameras of an E57 file's images2D, with poses and, where the file carries the vendor
/// extension for lens distortion (E57_LEICA_Camera_Distortion: OpenCV's rational model), the lens.
///
/// The standard's camera looks along -z with y up; it becomes OpenCV's here. Its principal point counts from
/// the centre of the top-left pixel. Spherical and cylindrical panoramas and pictures without a usable
/// focal length are named in the warnings.
class E57CameraReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The pinhole pictures that an E57 file carries (JPEG, PNG), in the order of E57CameraReader's poses.
class E57PictureReader : public PictureReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<PictureSetInfo> inspect(const std::string& path) const override;
  Result<std::unique_ptr<PictureSource>> open(const std::string& path) const override;
};

}  // namespace alidade
