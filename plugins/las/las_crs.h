// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>
#include <string>

namespace alidade {

/// What PROJ's database, or a WKT itself, says of a system's axes.
struct CrsUnits {
  bool degrees = false;      ///< longitude and latitude
  double metresPerUnit = 1;  ///< of x and y, where they are lengths
  std::string unit;          ///< its name
};

/// `crs`: "EPSG:n", "EPSG:n+m" (m: the heights) or WKT of either kind. Empty where PROJ knows no such system.
std::optional<CrsUnits> crsUnits(const std::string& crs);

/// WKT 1 (OGC 01-009, which LAS asks for) of "EPSG:n" or "EPSG:n+m"; empty where PROJ's database has none.
std::string wktOfEpsg(const std::string& crs);

/// The EPSG name of a WKT that is wktOfEpsg's to the letter; empty for any other, whose words are worth keeping.
std::string epsgOfWkt(const std::string& wkt);

}  // namespace alidade
