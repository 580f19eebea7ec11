// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The triangle kernel, written once in GCC's vector extension and included by one .cpp for each instruction
// set, which defines ALIDADE_LANES. Everything here has internal linkage.

#include "raster/triangle_kernel.h"
#include "raster/triangle_lanes.h"

namespace alidade {
namespace {

// Beyond, a corner's place is held: edge functions must fit 31 bits within a tile.
constexpr float kLeastPixel = -8192.0f, kLargestPixel = 24575.0f;
constexpr std::int64_t kFarOutside = std::int64_t{1} << 30;

struct Projected {
  Floats u, v, w, nx, ny;
};

template <LensKind kind>
ALIDADE_LENS_INLINE Projected project(const LensView& view, const float* positions, std::size_t stride,
                                      int count) {
  Floats x{}, y{}, z{};
  z += 1.0f;
  for (int i = 0; i < count; ++i) {
    const float* p = positions + static_cast<std::size_t>(i) * stride;
    x[i] = p[0];
    y[i] = p[1];
    z[i] = p[2];
  }
  Projected out;
  out.w = 1.0f / z;
  out.nx = x / z;
  out.ny = y / z;
  Floats xd, yd;
  distort<kind>(view.lens, out.nx, out.ny, xd, yd);
  out.u = smaller(larger(view.fx * xd + view.cx, all(kLeastPixel)), all(kLargestPixel));
  out.v = smaller(larger(view.fy * yd + view.cy, all(kLeastPixel)), all(kLargestPixel));
  return out;
}

/// `put(first, count, projected)` takes the lanes.
template <class Put>
ALIDADE_LENS_INLINE void projectAll(const LensView& view, const float* positions, std::size_t stride,
                                    std::size_t count, const Put& put) {
  const auto run = [&]<LensKind kind>() __attribute__((always_inline)) {
    for (std::size_t first = 0; first < count; first += kLanes) {
      const int some = count - first < kLanes ? static_cast<int>(count - first) : kLanes;
      put(first, some, project<kind>(view, positions + first * stride, stride, some));
    }
  };
  switch (view.lens.kind) {
    case LensKind::None:
      return run.template operator()<LensKind::None>();
    case LensKind::Radial:
      return run.template operator()<LensKind::Radial>();
    case LensKind::Brown:
      return run.template operator()<LensKind::Brown>();
    case LensKind::Full:
      return run.template operator()<LensKind::Full>();
    case LensKind::Fisheye:
      return run.template operator()<LensKind::Fisheye>();
  }
}

void projectCorners(const LensView& view, const float* positions, std::size_t stride, std::size_t count,
                    const ScreenCorners& out) {
  projectAll(
      view, positions, stride,
      count, [&](std::size_t first, int some, const Projected& p) __attribute__((always_inline)) {
        storeSome(out.x + first, roundedDown(256.0f * p.u + 0.5f), some);
        storeSome(out.y + first, roundedDown(256.0f * p.v + 0.5f), some);
        storeSome(out.w + first, p.w, some);
        storeSome(out.nx + first, p.nx, some);
        storeSome(out.ny + first, p.ny, some);
      });
}

void projectPoints(const LensView& view, const float* positions, std::size_t stride, std::size_t count,
                   const ScreenPoints& out) {
  projectAll(
      view, positions, stride,
      count, [&](std::size_t first, int some, const Projected& p) __attribute__((always_inline)) {
        storeSome(out.x + first, p.u, some);
        storeSome(out.y + first, p.v, some);
        storeSome(out.w + first, p.w, some);
      });
}

/// Calls `put(place, w, inside)` for the lanes of a tile that a triangle may cover; `place` counts pixels of
/// the tile.
template <bool masked, class Put>
ALIDADE_LENS_INLINE void scan(const ScreenTriangle& triangle, int tileLeft, int tileTop, float insideSquared,
                              const Put& put) {
  const ScreenTriangle t = triangle;  // what `put` writes is none of it
  const int xFirst = (t.left > tileLeft ? t.left - tileLeft : 0) & -kLanes;
  const int xLast = t.right - tileLeft < kTileSize - 1 ? t.right - tileLeft : kTileSize - 1;
  const int yFirst = t.top > tileTop ? t.top - tileTop : 0;
  const int yLast = t.bottom - tileTop < kTileSize - 1 ? t.bottom - tileTop : kTileSize - 1;
  Ints row[3];
  for (int k = 0; k < 3; ++k) {
    std::int64_t e =
        t.c[k] + std::int64_t{t.a[k]} * (tileLeft + xFirst) + std::int64_t{t.b[k]} * (tileTop + yFirst);
    e = e > kFarOutside ? kFarOutside : e < -kFarOutside ? -kFarOutside : e;
    row[k] = static_cast<std::int32_t>(e) + t.a[k] * kIota;
  }
  const Floats columns = toFloats(kIota + (tileLeft + xFirst - t.left));
  for (int y = yFirst; y <= yLast; ++y) {
    const auto dy = static_cast<float>(tileTop + y - t.top);
    const float w0 = t.w0 + t.wy * dy;
    Ints e0 = row[0], e1 = row[1], e2 = row[2];
    Floats dx = columns;
    for (int x = xFirst; x <= xLast; x += kLanes) {
      Ints inside = (e0 | e1 | e2) >= 0;
      if constexpr (masked) {
        const Floats nx = (t.nx0 + t.nxy * dy) + t.nxx * dx, ny = (t.ny0 + t.nyy * dy) + t.nyx * dx;
        inside &= nx * nx + ny * ny <= insideSquared;
      }
      put(y * kTileSize + x, w0 + t.wx * dx, inside);
      e0 += t.a[0] * kLanes;
      e1 += t.a[1] * kLanes;
      e2 += t.a[2] * kLanes;
      dx += static_cast<float>(kLanes);
    }
    for (int k = 0; k < 3; ++k) row[k] += t.b[k];
  }
}

template <bool masked>
void drawTile(const ScreenTriangle* triangles, const std::uint32_t* list, std::uint32_t count,
              float insideSquared, const VisibilityTile& tile) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t id = list[i];
    if (i + 4 < count) __builtin_prefetch(triangles + list[i + 4]);
    scan<masked>(
        triangles[id], tile.left, tile.top,
        insideSquared, [&](int place, const Floats& w, const Ints& inside) __attribute__((always_inline)) {
          const Floats old = load<Floats>(tile.inverseDepth + place);
          const Ints nearer = inside & (w > old);
          if (!any(nearer)) return;
          store(tile.inverseDepth + place, nearer ? w : old);
          const Words oldId = load<Words>(tile.triangle + place);
          store(tile.triangle + place, nearer ? all(id) : oldId);
        });
  }
}

template <bool masked>
void drawSecondTile(const ScreenTriangle* triangles, const std::uint32_t* list, std::uint32_t count,
                    float insideSquared, float nearest, const SecondLayerTile& tile) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t id = list[i];
    if (i + 4 < count) __builtin_prefetch(triangles + list[i + 4]);
    const ScreenTriangle& t = triangles[id];
    if (t.rank < 0) continue;
    scan<masked>(
        t, tile.left, tile.top,
        insideSquared, [&](int place, const Floats& w, const Ints& inside) __attribute__((always_inline)) {
          const Floats old = load<Floats>(tile.key + place);
          const Floats key = t.rank + nearest * w;
          const Ints first = inside & (key > old) & (load<Words>(tile.owner + place) != t.owner);
          if (!any(first)) return;
          store(tile.key + place, first ? key : old);
          store(tile.inverseDepth + place, first ? w : load<Floats>(tile.inverseDepth + place));
          store(tile.triangle + place, first ? all(id) : load<Words>(tile.triangle + place));
        });
  }
}

void draw(const ScreenTriangle* triangles, const std::uint32_t* list, std::uint32_t count,
          float insideSquared, const VisibilityTile& tile) {
  (insideSquared < 1e30f ? drawTile<true> : drawTile<false>)(triangles, list, count, insideSquared, tile);
}

void drawSecond(const ScreenTriangle* triangles, const std::uint32_t* list, std::uint32_t count,
                float insideSquared, float nearest, const SecondLayerTile& tile) {
  (insideSquared < 1e30f ? drawSecondTile<true> : drawSecondTile<false>)(triangles, list, count,
                                                                         insideSquared, nearest, tile);
}

}  // namespace
}  // namespace alidade
