// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>

namespace alidade {

/// Pictures of ever coarser pixels, one after another in one buffer: level 0 is the picture, a cell of level k covers 2^k × 2^k of
/// its pixels. Points that are farther apart than a pixel fall into cells that are as wide as they are apart, and so make a surface
/// at the cost of two dots each, however wide they are (see raster/level_surface.h). Coarse levels have a margin of kMargin
/// cells on each side for points just outside of the picture.
struct SplatLevels {
  static constexpr int kMost = 8;
  static constexpr int kMargin = 2;

  std::int32_t count = 1;
  std::int32_t columns[kMost] = {}, rows[kMost] = {};  ///< margins included
  std::int32_t start[kMost] = {};                      ///< of the buffer's pixels, the level's first

  SplatLevels() = default;
  SplatLevels(int width, int height, int levels) : count(levels) {
    for (std::int32_t k = 0, next = 0; k < levels; next += columns[k] * rows[k], ++k) {
      start[k] = next;
      columns[k] = cells(width, k);
      rows[k] = cells(height, k);
    }
  }

  std::size_t pixels() const {
    const int last = count - 1;
    return static_cast<std::size_t>(start[last]) + static_cast<std::size_t>(columns[last]) * static_cast<std::size_t>(rows[last]);
  }

 private:
  static std::int32_t cells(int pixels, int k) { return k == 0 ? pixels : ((pixels + (1 << k) - 1) >> k) + 2 * kMargin; }
};

/// Where in its cell the point fell that a pixel carries above its colour: 8 bits each of u and v from the cell's first corner on. None
/// in level 0.
struct PlaceInCell {
  static constexpr int kColourBits = 16;
  static constexpr float kSteps = 256.0f;
};

}  // namespace alidade
