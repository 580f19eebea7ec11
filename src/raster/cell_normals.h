// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

#include "cloud/point_store.h"

namespace alidade {

/// How the surface lies in each cell of a node, fitted to a sample of its points: what a footprint's depth and size
/// follow. Cells are cubes of 2^shift node steps, kPerEdge along the longest edge of the points' box.
struct CellNormals {
  static constexpr int kPerEdge = 8;
  std::array<std::int32_t, 3> low{};  ///< node steps where cell 0 begins
  std::int32_t shift = 0;
  /// By x + 8 (y + 8 z): a unit normal in the camera's axes, then how far apart the points are there, as a part of the
  /// node's own spacing. (0, 0, 0, 1) where the points of a cell are few or no plane.
  std::array<glm::vec4, kPerEdge * kPerEdge * kPerEdge> normal;
};

/// `spacing`: the node's own, in node steps.
CellNormals cellNormals(std::span<const DisplayPoint> points, double spacing, const glm::dmat3& cameraFromWorld);

}  // namespace alidade
