// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

#include "plugin_api/reader.h"

namespace alidade {

// Bundler and BAL share one camera (Snavely, Bundler user's manual, "Output format"; Agarwal, "Bundle Adjustment in the
// Large"):
//     P = R X + t,  p = -P / P.z,  p' = f (1 + k1 |p|² + k2 |p|⁴) p,
// which looks along -z, pixels from the middle of the picture with y up. Half a turn about x makes the axes
// OpenCV's, and the middle of the picture is (w-1)/2, (h-1)/2 from the centre of the top-left pixel.
//
// Neither file states the pictures' size. It comes from the pictures where list.txt names them and they are there;
// else the cameras are without size (CameraSet::camerasWithoutSize) until somebody knows their picture.

/// Bundler v0.3 (`bundle.out`). Names come from list.txt beside the file, one folder up, or FILE.list.txt. Cameras that
/// were not registered (f = 0) keep their place in the order and have no pose.
///
/// Refused, with the line: other versions, missing or broken numbers, matrices that are no rotation, views of cameras
/// that are not there, counts beyond the file.
class BundlerReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// A problem of "Bundle Adjustment in the Large", plain text: `cameras points observations`, a line an
/// observation (camera, point, x, y), nine numbers a camera (rotation vector, t, f, k1, k2), three a point.
class BalReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The same of texts in memory; `path` is for messages.
Result<CameraSet> parseBundler(std::string_view text, const std::string& path, const Progress& progress);
Result<CameraSet> parseBal(std::string_view text, const std::string& path, const Progress& progress);

}  // namespace alidade
