// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string_view>

#include "plugin_api/reader.h"

namespace alidade {

/// Stake-out and control points as text: CSV with comma, semicolon, tab or blanks between the
/// fields. Quotes as RFC 4180, byte order mark, remarks (# or //) and Latin-1 are understood; with
/// semicolons or tabs a decimal comma, too, and ' between thousands (2'600'000.0).
///
/// With a header the columns stand in any order: name (number, id, point, Punkt …), E (easting, x,
/// Rechtswert …), N (northing, y, Hochwert …), H (height, z, Höhe …), code (description …), tolerance
/// (tol, Toleranz …); a unit may follow ("tol [mm]"); other columns are passed over. Without one
/// they are name, E, N, H and perhaps code.
///
/// Refused, with the line: fields that are missing, no numbers, not finite, or beyond 1e9 m. Warned
/// of: names that come twice, x and y (which surveyors also use the other way round), names made up.
class StakePointReader : public PointListReader {
 public:
  ReaderDescription description() const override;
  int sniff(const FileProbe& probe) const override;
  Result<PointList> read(const std::string& path) const override;
};

/// The same of a text in memory; `path` is for messages.
Result<PointList> parseStakePoints(std::string_view text, const std::string& path);

}  // namespace alidade
