// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/point_store.h"
#include "survey/design_model.h"

namespace alidade {

struct DeviationOptions {
  double searchM = 0.15;          ///< scan points farther from every element than this are no part of it
  std::uint64_t maximumPoints = 2'000'000;  ///< a larger cloud is thinned evenly, coarse levels first
  Result<void> validate() const;
};

/// How far the scan lies from one element of the design.
struct ElementDeviation {
  std::uint32_t element = 0;   ///< index in the design
  std::uint64_t points = 0;    ///< scan points nearest to this element within the search distance
  double medianM = 0;          ///< signed: above 0 outside the solid, along the face's normal
  double p95M = 0;             ///< 95th percentile of the absolute distance
};

/// Signed distance of every scan point to the nearest design face (Embree's point query, float
/// relative to the design's origin: below 0.1 mm within 1 km), gathered by element. Elements that no
/// point is near do not appear.
Result<std::vector<ElementDeviation>> deviations(const PointStore& cloud, const DesignModel& design,
                                                 const DeviationOptions& options, const Progress& progress);

}  // namespace alidade
