// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

namespace alidade {

/// A box of lattice units, both ends included.
struct UnitBox {
  glm::i64vec3 low{0}, high{-1};
  void add(const UnitBox& other);
  bool touches(const UnitBox& other, std::int64_t reach) const;
};

/// In which order boxes are worked on, so that neighbours of an earlier colour are known: a greedy colouring of
/// the graph of boxes that lie within a tile's edge of another.
struct WorkOrder {
  std::vector<std::uint32_t> order;                   ///< box indices, colour by colour
  std::vector<std::vector<std::uint32_t>> before;     ///< of each box: the neighbours of earlier colours
};

WorkOrder workOrderOf(const std::vector<UnitBox>& boxes, std::int64_t reach);

}  // namespace alidade
