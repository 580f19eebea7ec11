// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>

#include "camera/lens_kernel.h"

namespace alidade {

/// Pixels along the side of a tile.
inline constexpr int kTileSize = 64;
inline constexpr int kTilePixels = kTileSize * kTileSize;

/// A triangle on the screen. Corners are snapped to 1/256 pixel, so that the three edge functions are whole
/// numbers and two triangles at an edge neither share a pixel nor leave one out (the top-left rule).
struct alignas(64) ScreenTriangle {
  /// A pixel's centre lies inside where a x + b y + c >= 0 for all three; x and y whole pixels.
  std::int64_t c[3];
  std::int32_t a[3], b[3];
  std::int16_t left = 0, right = -1, top = 0,
               bottom = -1;  ///< pixels to look at, inclusive; empty: not drawn
  float w0, wx, wy;          ///< inverse depth: w0 at (left, top) and its slopes
  float nx0, nxx, nxy;       ///< X/Z before the lens, likewise
  float ny0, nyx, nyy;
  std::uint32_t owner;  ///< whose triangle it is
  float rank;           ///< in the second layer: large before near; negative: not in that layer
  float normal[3];      ///< the rest is for whoever shades it: camera axes, unit
  std::uint32_t colour, mark;
};
static_assert(sizeof(ScreenTriangle) == 128);

/// Corners on the screen, one array a quantity.
struct ScreenCorners {
  std::int32_t* x;  ///< pixels × 256
  std::int32_t* y;
  float* w;   ///< 1 / depth
  float* nx;  ///< X/Z, Y/Z
  float* ny;
};

/// Where unsnapped ends are wanted: pixels.
struct ScreenPoints {
  float* x;
  float* y;
  float* w;
};

struct LensView {
  Lens<float> lens;
  float fx, fy, cx, cy;
};

/// One thread's tile of the visibility buffer: rows of kTileSize. What lies beyond the picture is scratch.
struct VisibilityTile {
  int left = 0, top = 0;  ///< pixel of the picture
  float* inverseDepth = nullptr;
  std::uint32_t* triangle = nullptr;
};

/// The second layer of a tile. `key` holds rank + nearest × inverse depth of what is there, infinity where
/// nothing may be drawn; `owner` is the first layer's, which is not drawn twice.
struct SecondLayerTile {
  int left = 0, top = 0;
  const std::uint32_t* owner = nullptr;
  float* key = nullptr;
  float* inverseDepth = nullptr;
  std::uint32_t* triangle = nullptr;
};

/// Triangles in floats, chosen at run time for the processor. All three give the same bit for bit.
struct TriangleKernel {
  const char* name;
  /// Positions in camera axes (z > 0), `stride` floats apart, through the lens.
  void (*projectCorners)(const LensView& view, const float* positions, std::size_t stride, std::size_t count,
                         const ScreenCorners& out);
  void (*projectPoints)(const LensView& view, const float* positions, std::size_t stride, std::size_t count,
                        const ScreenPoints& out);
  /// The nearest triangle of each pixel; of equally near ones the first. Pixels farther from the axis than
  /// `insideSquared` on the image plane are left out; infinity where the lens never folds back.
  void (*draw)(const ScreenTriangle* triangles, const std::uint32_t* list, std::uint32_t count,
               float insideSquared, const VisibilityTile& tile);
  /// The triangle of the largest key; `nearest` metres have the key 1 within a rank.
  void (*drawSecond)(const ScreenTriangle* triangles, const std::uint32_t* list, std::uint32_t count,
                     float insideSquared, float nearest, const SecondLayerTile& tile);
};

extern const TriangleKernel kScalarTriangleKernel;
#if defined(__x86_64__)
extern const TriangleKernel kAvx2TriangleKernel;
extern const TriangleKernel kAvx512TriangleKernel;
#endif

/// Of the same instruction set as splatKernel().
const TriangleKernel& triangleKernel();

/// Fills what owner stands behind from three corners; leaves an empty box where no pixel's centre is covered.
void setUpTriangle(const ScreenCorners& corners, const std::uint32_t (&corner)[3], int width, int height,
                   ScreenTriangle& triangle);

/// True where a pixel of the tile may lie in the triangle.
inline bool touchesTile(const ScreenTriangle& t, int left, int top) {
  for (int k = 0; k < 3; ++k) {
    const std::int64_t x = t.a[k] > 0 ? left + kTileSize - 1 : left,
                       y = t.b[k] > 0 ? top + kTileSize - 1 : top;
    if (t.c[k] + t.a[k] * x + t.b[k] * y < 0) return false;
  }
  return true;
}

}  // namespace alidade
