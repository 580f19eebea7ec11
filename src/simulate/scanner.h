// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "geometry/rigid_transform.h"
#include "simulate/lighting.h"
#include "simulate/site_model.h"

namespace alidade {

/// How the simulated instrument measures.
struct ScannerModel {
  double heightMeters = 1.75;        ///< of the mirror above the ground point
  double lowestElevation = -1.0472;  ///< radians below the horizon hidden by the tripod
  double highestElevation = 1.5708;
  double rangeMeters = 90.0;
  double rangeNoiseMeters = 0.0022;  ///< one sigma on a white surface at 10 m; grows on dark and far ones
  double beamRadians = 0.00035;      ///< full divergence: decides how often a shot straddles an edge
  double mixedLimitMeters = 4.0;     ///< two surfaces farther apart than this come back as two, not mixed
};

/// One set-up: where it stands and the grid that it measured.
struct ScanStation {
  std::string name;
  RigidTransform worldFromScanner;  ///< scanner: x at column 0, z up
  RigidTransform siteFromScanner;
  std::uint32_t rows = 0, columns = 0;
  std::uint64_t points = 0;
  std::uint64_t mixedPixels = 0;
};

struct ScanSummary {
  std::vector<ScanStation> stations;
  std::uint64_t points = 0;
  double stepRadians = 0;
};

/// Scans the site from all stations into a LAS file. The angular step is chosen so that about `points` shots
/// hit something. Column by column, so that memory does not grow with the number of points.
///
/// Row i, column j look along elevation e = highest - (i + 0.5) (highest - lowest) / rows and azimuth
/// a = 2 pi (j + 0.5) / columns: direction (cos e cos a, cos e sin a, sin e) in the scanner's frame.
Result<ScanSummary> writeScan(const std::string& path, const SiteModel& site, const RayScene& scene,
                              const Lighting& lighting, const ScannerModel& model, std::uint64_t points,
                              std::uint32_t seed, bool colour, const Progress& progress);

}  // namespace alidade
