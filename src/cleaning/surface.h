// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "base/progress.h"

namespace alidade {

/// Triangles over a cloud, in the cloud's own world coordinates.
struct SurfaceMesh {
  std::vector<glm::dvec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct GreedyOptions {
  double edgeMeters = 0.2;  ///< longest edge
};

struct PoissonOptions {
  int depth = 9;  ///< of the octree: 2^depth cells along the longest side
};

// Both need a normal a point, hold the whole cloud and its mesh in memory, and refuse more than 20 million points.
// The library cannot be interrupted: cancelling takes effect before and after it.

/// Greedy projection triangulation (Marton et al. 2009): joins the points themselves.
Result<SurfaceMesh> meshGreedily(std::span<const glm::dvec3> points, std::span<const glm::vec3> normals, const GreedyOptions& options,
                                 const Progress& progress);

/// Poisson reconstruction (Kazhdan et al. 2006): a closed surface near the points.
Result<SurfaceMesh> meshByPoisson(std::span<const glm::dvec3> points, std::span<const glm::vec3> normals, const PoissonOptions& options,
                                  const Progress& progress);

/// Writes binary PLY or OBJ, by the path's ending. Coordinates are written as doubles: nothing is shifted.
Result<void> writeSurface(const SurfaceMesh& mesh, const std::string& path);

}  // namespace alidade
