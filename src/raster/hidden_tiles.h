// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "raster/level_surface.h"
#include "raster/splat_pass.h"

namespace alidade {

/// Behind which depth nothing more of a picture can be seen, by tiles of 8×8 pixels: what the nearest runs have drawn hides most
/// of the others, which then need not be drawn. Taken from the surfaces of level 1 and above, whose holes are closed, of a whole part of
/// the runs at a time, not as the threads go, so that the picture does not depend on who drew first.
class HiddenTiles {
 public:
  static constexpr int kSize = 8;
  HiddenTiles(int width, int height);

  /// `surface`: of level 1.
  void look(const LevelSurface& surface);

  /// Metres, by tile: the farthest that can be seen in it and in the eight around it; +inf where something is bare.
  const float* farthest() const { return m_farthest.data(); }
  int columns() const { return m_columns; }

  /// Whether all of the run's box, in front of the camera and on a small part of the picture, lies behind.
  bool hides(const SplatRun& run) const;

 private:
  int m_columns, m_rows;
  std::vector<float> m_own, m_farthest;
};

}  // namespace alidade
