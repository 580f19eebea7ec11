// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "cleaning/cleaning.h"
#include "cleaning/tile_search.h"

namespace alidade {

namespace {

constexpr double kLonely = std::numeric_limits<double>::infinity();

}  // namespace

Result<KeepMask> removeStatisticalOutliers(std::span<const glm::dvec3> points, const StatisticalOutlierOptions& options,
                                           const Progress& progress) {
  if (options.neighbours < 1 || options.neighbours > 1000 || !std::isfinite(options.deviations))
    return fail(fmt::format("Outliers cannot be told by {} neighbours and {} deviations", options.neighbours, options.deviations), {},
                "Give 1 to 1000 neighbours, for example 8,1.0");
  std::vector<double> meanDistance(points.size(), kLonely);
  const int wanted = options.neighbours + 1;  // the point itself comes first
  // A point whose neighbours may stand beyond the tile's reach is sparser than nearly all others.
  const auto ok = forTiles(points, typicalReach(points, wanted), "Looking for outliers", progress, [&](const TileSearch& tile) {
    pcl::Indices found;
    std::vector<float> squared;
    for (std::size_t i = 0; i < tile.ownCount; ++i) {
      if (tile.tree.nearestKSearch(static_cast<int>(i), wanted, found, squared) < wanted) continue;
      double sum = 0;
      for (const float each : squared) sum += std::sqrt(static_cast<double>(each));
      meanDistance[tile.index[i]] = sum / options.neighbours;
    }
  });
  if (!ok) return fail(ok.error());
  double sum = 0, squares = 0, count = 0;
  for (const double each : meanDistance) {
    if (each == kLonely) continue;
    sum += each;
    squares += each * each;
    ++count;
  }
  const double mean = count > 0 ? sum / count : 0;
  const double variance = count > 1 ? std::max(0.0, (squares - sum * mean) / (count - 1)) : 0;
  const double most = mean + options.deviations * std::sqrt(variance);
  KeepMask keep(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) keep[i] = meanDistance[i] <= most;
  return keep;
}

Result<KeepMask> removeRadiusOutliers(std::span<const glm::dvec3> points, const RadiusOutlierOptions& options, const Progress& progress) {
  if (!(options.radiusMeters > 0) || !std::isfinite(options.radiusMeters) || options.neighbours < 1)
    return fail(fmt::format("Outliers cannot be told by {} neighbours within {} m", options.neighbours, options.radiusMeters), {},
                "Give a radius above 0 and at least one neighbour, for example 0.1,4");
  KeepMask keep(points.size(), 0);
  const auto ok = forTiles(points, options.radiusMeters, "Looking for lonely points", progress, [&](const TileSearch& tile) {
    pcl::Indices found;
    std::vector<float> squared;
    const auto wanted = static_cast<unsigned>(options.neighbours) + 1;
    for (std::size_t i = 0; i < tile.ownCount; ++i)
      keep[tile.index[i]] = tile.tree.radiusSearch(static_cast<int>(i), options.radiusMeters, found, squared, wanted) >= static_cast<int>(wanted);
  });
  if (!ok) return fail(ok.error());
  return keep;
}

}  // namespace alidade
