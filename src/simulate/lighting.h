// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "simulate/ray_scene.h"

namespace alidade {

/// The light of a fair day: a sun with sharp shadows, and a sky whose share at a place comes from how much of
/// it is seen there: a coarse grid of six cosine-weighted openings (an ambient cube, McTaggart 2004),
/// ray-cast once.
class Lighting {
 public:
  explicit Lighting(const RayScene& scene);

  /// Linear radiance that leaves a point towards `toViewer` (unit); `sunlit` tells whether the sun reaches
  /// it.
  glm::vec3 shade(const glm::dvec3& position, const RayHit& hit, const glm::vec3& toViewer, float footprint,
                  bool* sunlit = nullptr) const;

  /// Linear radiance of the sky in a unit direction.
  static glm::vec3 sky(const glm::vec3& direction);

 private:
  float openness(const glm::vec3& position, const glm::vec3& normal) const;
  void bake();

  const RayScene& m_scene;
  glm::vec3 m_towardsSun;
  glm::vec3 m_low{-13.0f, -11.0f, -2.2f};
  float m_cell = 0.5f;
  glm::ivec3 m_cells{60, 46, 18};
  std::vector<std::array<float, 6>>
      m_open;  ///< share of the sky seen, by +x -x +y -y +z -z; < 0 inside a solid
};

/// Linear radiance to an 8-bit sRGB value in [0,1] with a soft shoulder.
glm::vec3 displayColour(const glm::vec3& radiance);

}  // namespace alidade
