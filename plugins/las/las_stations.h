// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <span>
#include <string>
#include <vector>

#include "las/las_header.h"

namespace alidade {

// LAS has no place for where a scanner stood. Alidade keeps it in a record of its own: user ID "alidade", record ID 1,
// description "Scanner stations", payload JSON in UTF-8:
//
//   {"stations": [{"name": "S1", "point_source_id": 1, "rows": 1000, "columns": 2000,
//                  "world_from_scanner": {"rotation_wxyz": [w, x, y, z], "translation_m": [x, y, z]}}, …]}
//
// The station's points carry its point source ID. Rows and columns are those of the scanner's grid, 0 where it has none;
// a point's own stand in extra bytes "row" and "column". Other programs pass over the record.

constexpr const char* kStationsUser = "alidade";
constexpr int kStationsRecord = 1;

/// Error text where the payload is no such record; else the stations.
Result<std::vector<LasStation>> parseStations(std::span<const std::byte> payload);
std::vector<std::byte> makeStations(const std::vector<Station>& stations);

}  // namespace alidade
