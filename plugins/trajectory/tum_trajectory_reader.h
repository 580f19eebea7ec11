// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "plugin_api/reader.h"

namespace alidade {

/// A trajectory as the TUM RGB-D benchmark writes it: `timestamp tx ty tz qx qy qz qw` a line, camera
/// to world, lines with # are remarks (Sturm et al. 2012, "File Formats"). The poses come out as
/// camera from world, without names and without cameras.
///
/// Refused, with the line: anything but eight numbers, non-finite numbers, a zero quaternion.
/// Tolerated with a warning: times out of order (they are sorted), times that come twice,
/// quaternions off unit length by more than a thousandth (they are normalised).
class TumTrajectoryReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The same of a text in memory; `path` is for messages.
Result<CameraSet> parseTumTrajectory(std::string_view text, const std::string& path, const Progress& progress);

}  // namespace alidade
