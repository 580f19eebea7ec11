// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/progress.h"

namespace alidade {

// Thinning and cleaning of a cloud. All take world positions (metres, double) and answer with one byte a
// point: 1 keeps it. Points are chosen, never moved. Search trees are built tile by tile in float about the
// tile's own middle, so memory beyond the input is a few tiles and ten bytes a point.
// Every one fails where an option makes no sense, for 2^32 points and more, and when cancelled.

using KeepMask = std::vector<std::uint8_t>;

/// Keeps of each cube of `edgeMeters` the point nearest to the mean of its points.
Result<KeepMask> thinByVoxel(std::span<const glm::dvec3> points, double edgeMeters, const Progress& progress);

struct StatisticalOutlierOptions {
  int neighbours = 8;
  double deviations = 1.0;  ///< standard deviations above the mean
};

/// Statistical outlier removal (Rusu et al. 2008): drops the points whose mean distance to their nearest
/// neighbours exceeds the mean of all those plus some standard deviations. A point without enough
/// neighbours within reach of its tile is dropped, and left out of the statistics.
Result<KeepMask> removeStatisticalOutliers(std::span<const glm::dvec3> points, const StatisticalOutlierOptions& options,
                                           const Progress& progress);

struct RadiusOutlierOptions {
  double radiusMeters = 0.1;
  int neighbours = 4;  ///< other points wanted within the radius
};

/// Drops the points with fewer others around them.
Result<KeepMask> removeRadiusOutliers(std::span<const glm::dvec3> points, const RadiusOutlierOptions& options, const Progress& progress);

struct GroundOptions {
  double cellMeters = 0.5;
  double largestWindowMeters = 20;  ///< wider things that stand on the ground are taken for it
  double slope = 1.0;               ///< rise over run of the ground
  double firstHeightMeters = 0.15;  ///< above the lowest surface, still ground
  double largestHeightMeters = 2.5;
};

/// Marks ground points with 1 by the progressive morphological filter (Zhang et al. 2003) on a grid of lowest
/// points: what an opening with growing windows takes down by more than a height that grows with the window is no ground.
Result<KeepMask> classifyGround(std::span<const glm::dvec3> points, const GroundOptions& options, const Progress& progress);

struct NormalOptions {
  int neighbours = 12;
};

/// A unit normal a point: of the plane through its nearest neighbours, towards where it was seen from. `viewpoints`
/// are the stations; `seenFrom` has an index into them a point, or is empty for the first one. Without any, normals look up. Points
/// with fewer than three neighbours get (0, 0, 1).
Result<std::vector<glm::vec3>> estimateNormals(std::span<const glm::dvec3> points, std::span<const glm::dvec3> viewpoints,
                                               std::span<const std::uint16_t> seenFrom, const NormalOptions& options, const Progress& progress);

}  // namespace alidade
