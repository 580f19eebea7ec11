// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace alidade {

/// What COPC says of its tree (copc.io, "info VLR").
struct CopcInfo {
  glm::dvec3 centre{0};
  double halfSize = 0;  ///< of the cube, metres
  double spacing = 0;   ///< between points of the root, metres
  std::uint64_t rootOffset = 0, rootSize = 0;  ///< of the hierarchy's root page, bytes
  double firstTime = 0, lastTime = 0;

  static constexpr std::size_t kSize = 160;
  static CopcInfo parse(const std::byte* payload);
  std::vector<std::byte> bytes() const;
};

}  // namespace alidade
