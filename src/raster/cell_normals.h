// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "cloud/point_store.h"

namespace alidade {

/// How the surface lies in each cell of a node, fitted to an even sample of its points: what a footprint's
/// depth follows. Cells are cubes of 2^shift node steps, kPerEdge along the longest edge of the points' box.
struct CellNormals {
  static constexpr int kPerEdge = 8;
  std::array<std::int32_t, 3> low{};  ///< node steps where cell 0 begins
  std::int32_t shift = 0;
  /// Unit normals in the camera's axes by x + 8 (y + 8 z); zero where the points of a cell are few or no
  /// plane.
  std::array<glm::vec3, kPerEdge * kPerEdge * kPerEdge> normal{};
};

/// `points` in the order of their levels, of which a prefix is an even sample.
CellNormals cellNormals(std::span<const DisplayPoint> points, const glm::dmat3& cameraFromWorld);

}  // namespace alidade
