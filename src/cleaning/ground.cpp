// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>
#include <pcl/segmentation/approximate_progressive_morphological_filter.h>

#include "cleaning/cleaning.h"
#include "cleaning/tile_search.h"

namespace alidade {

namespace {

constexpr std::size_t kTilePoints = 2000000;
constexpr double kMostCells = 16e6;

Result<void> check(const GroundOptions& options) {
  const double all[] = {options.cellMeters, options.largestWindowMeters, options.slope, options.firstHeightMeters, options.largestHeightMeters};
  if (std::all_of(std::begin(all), std::end(all), [](double v) { return v > 0 && std::isfinite(v); }) &&
      options.largestWindowMeters >= options.cellMeters)
    return {};
  return fail("The ground's cell, window, slope and heights must be above 0, and the window no smaller than a cell", {}, "Leave them at their defaults");
}

}  // namespace

Result<KeepMask> classifyGround(std::span<const glm::dvec3> points, const GroundOptions& options, const Progress& progress) {
  if (auto ok = check(options); !ok) return fail(ok.error());
  if (points.size() >= UINT32_MAX) return fail("The cloud has more points than can be classified at once", {}, "Classify its scans one by one");
  KeepMask ground(points.size(), 0);
  const PointTiles tiles(points, kTilePoints, true);
  for (std::size_t i = 0; i < tiles.count(); ++i) {
    if (progress.cancelled()) return fail(cancelledError());
    // Opening looks one window around, twice: down and up again.
    const double margin = 2 * options.largestWindowMeters;
    const std::vector<std::uint32_t> index = tiles.around(i, margin);
    const glm::dvec3 size = tiles.bounds(i).size() + 2 * margin;
    if (size.x * size.y / (options.cellMeters * options.cellMeters) > kMostCells)
      return fail(fmt::format("Cells of {} m are too small for ground of {:.0f} × {:.0f} m", options.cellMeters, size.x, size.y), {},
                  "Remove far outliers first or give larger cells");
    try {
      pcl::ApproximateProgressiveMorphologicalFilter<pcl::PointXYZ> filter;
      filter.setInputCloud(pclCloud(points, index, tiles.bounds(i).centre()));
      filter.setCellSize(static_cast<float>(options.cellMeters));
      filter.setMaxWindowSize(std::max(3, static_cast<int>(options.largestWindowMeters / options.cellMeters)));
      filter.setSlope(static_cast<float>(options.slope));
      filter.setInitialDistance(static_cast<float>(options.firstHeightMeters));
      filter.setMaxDistance(static_cast<float>(options.largestHeightMeters));
      filter.setNumberOfThreads(1);  // its threads race for a cell's lowest point
      pcl::Indices found;
      filter.extract(found);
      for (const int each : found)
        if (static_cast<std::size_t>(each) < tiles.own(i).size()) ground[index[static_cast<std::size_t>(each)]] = 1;
    } catch (const std::exception& error) {
      return fail(std::string("The ground cannot be classified: ") + error.what(), {}, "Thin the cloud first");
    }
    progress.report(static_cast<double>(i + 1) / static_cast<double>(tiles.count()), "Classifying the ground");
  }
  return ground;
}

}  // namespace alidade
