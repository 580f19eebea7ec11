// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

#include "plugin_api/reader.h"

namespace alidade {

/// Camera positions and angles as a table with a header: name, easting, northing, height, and three angles. Commas,
/// semicolons or tabs between the columns; a leading # before the header is allowed; case and order do not matter.
///
///     name        name, label, image, image_name, filename, file, photo, picture
///     position    x y z | e n h | easting northing height | east north up, also elevation, altitude
///     angles      omega phi kappa: worldFromPhoto = Rx(omega) Ry(phi) Rz(kappa) (Kraus; Pix4D, PATB)
///                 yaw pitch roll: all 0 looks straight down, the top to the north (Metashape, Pix4D)
///                 gimbal_yaw gimbal_pitch gimbal_roll: all 0 looks north, level (drones' gimbals)
///     time        time, timestamp, time_s: seconds; optional
///
/// A unit may follow a column's name: omega_deg, kappa [gon], "yaw (rad)", x_m. Angles without unit are degrees, with a
/// warning; the unit of one angle must be that of all. World is E-N-Up; geometry/attitude.h has the formulas.
///
/// Refused: latitude or longitude columns, feet, two kinds of angles in one table, missing columns, each by name;
/// rows with missing or non-finite numbers, by line. The poses have no camera: a calibration file brings it.
class PoseTableReader : public CameraReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<CameraSet> inspect(const std::string& path) const override;
  Result<CameraSet> read(const std::string& path, const Progress& progress) const override;
};

/// The same of a text in memory; `path` is for messages.
Result<CameraSet> parsePoseTable(std::string_view text, const std::string& path, const Progress& progress);

}  // namespace alidade
