// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The splat kernel, written once in GCC's vector extension and included by one .cpp for each
// instruction set, which defines ALIDADE_SPLAT_LANES. Everything here has internal linkage.

#include <cmath>
#include <cstring>

#if defined(__SSE__)
#include <immintrin.h>
#endif

#include "raster/splat_kernel.h"

namespace alidade {
namespace {

constexpr int kLanes = ALIDADE_SPLAT_LANES;
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * kLanes)));

#if ALIDADE_SPLAT_LANES == 16
#define ALIDADE_EVEN 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30
#define ALIDADE_ODD 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31
constexpr Words kIota = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif ALIDADE_SPLAT_LANES == 8
#define ALIDADE_EVEN 0, 2, 4, 6, 8, 10, 12, 14
#define ALIDADE_ODD 1, 3, 5, 7, 9, 11, 13, 15
constexpr Words kIota = {0, 1, 2, 3, 4, 5, 6, 7};
#else
#define ALIDADE_EVEN 0, 2, 4, 6
#define ALIDADE_ODD 1, 3, 5, 7
constexpr Words kIota = {0, 1, 2, 3};
#endif

struct Projected {
  Floats u, v, z;
  Ints valid;  ///< all ones where the lens holds and z > 0
  Words colour;
  Floats x, y;  ///< before the lens
  Ints cell;    ///< of CellNormals, where the view has them
};

ALIDADE_LENS_INLINE Floats estimatedReciprocal(const Floats& z) {
#if ALIDADE_SPLAT_LANES == 16
  return _mm512_rcp14_ps(z);
#elif ALIDADE_SPLAT_LANES == 8
  return _mm256_rcp_ps(z);
#elif defined(__SSE__)
  return _mm_rcp_ps(z);
#else
  return 1.0f / z;
#endif
}

ALIDADE_LENS_INLINE Floats reciprocalOf(const SplatView& view, const Floats& z) {
  switch (view.reciprocal) {
    case Reciprocal::Newton: {
      const Floats estimate = estimatedReciprocal(z);
      return estimate * (2.0f - z * estimate);
    }
    case Reciprocal::MultiplyAdd:
      return view.twoOverR - z * view.overRSquared;
    default:
      return 1.0f / z;
  }
}

/// Along one axis; points outside the sample's box count to its outermost cells.
ALIDADE_LENS_INLINE Ints cellOf(const Ints& step, std::int32_t low, std::int32_t shift) {
  const Ints cell = (step - low) >> shift;
  const Ints first = Ints{}, last = Ints{} + 7;
  const Ints atLeast = cell > first ? cell : first;
  return atLeast < last ? atLeast : last;
}

template <LensKind kind>
ALIDADE_LENS_INLINE Projected project(const SplatView& view, const std::uint16_t* points) {
  Words first, second;
  std::memcpy(&first, points, sizeof first);
  std::memcpy(&second, points + 2 * kLanes, sizeof second);
  const Words xy = __builtin_shufflevector(first, second, ALIDADE_EVEN);
  const Words zc = __builtin_shufflevector(first, second, ALIDADE_ODD);
  const Floats nx = __builtin_convertvector(Ints(xy & 0xffff), Floats);
  const Floats ny = __builtin_convertvector(Ints(xy >> 16), Floats);
  const Floats nz = __builtin_convertvector(Ints(zc & 0xffff), Floats);

  const float* m = view.m;
  const Floats px = (m[0] * nx + m[1] * ny) + (m[2] * nz + view.t[0]);
  const Floats py = (m[3] * nx + m[4] * ny) + (m[5] * nz + view.t[1]);
  const Floats pz = (m[6] * nx + m[7] * ny) + (m[8] * nz + view.t[2]);
  const Floats inverse = reciprocalOf(view, pz);
  const Floats x = px * inverse;
  const Floats y = py * inverse;
  Floats xd, yd;
  distort<kind>(view.lens, x, y, xd, yd);

  Projected p;
  p.x = x;
  p.y = y;
  p.cell = Ints{};
  if (view.cellNormals) {
    p.cell = cellOf(Ints(xy & 0xffff), view.cellLow[0], view.cellShift) +
             8 * cellOf(Ints(xy >> 16), view.cellLow[1], view.cellShift) +
             64 * cellOf(Ints(zc & 0xffff), view.cellLow[2], view.cellShift);
  }
  p.u = view.fx * xd + view.cx;
  p.v = view.fy * yd + view.cy;
  p.z = pz;
  // NaN fails each comparison, so a point that goes wrong anywhere is left out.
  const Floats r2 = x * x + y * y;
  p.valid = (pz > 1e-6f) & (r2 <= view.foldBackSquared);
  if (view.checkDomain) {
    const Ints doubtful = p.valid & (r2 > view.surelyInsideSquared);
    for (int i = 0; i < kLanes; ++i) {
      if (doubtful[i] && !view.inDomain(view.camera, x[i], y[i])) p.valid[i] = 0;
    }
  }
  p.colour = zc >> 16;
  return p;
}

ALIDADE_LENS_INLINE Words payloadOf(const SplatTarget& target, std::uint32_t place, const Words& colour) {
  switch (target.payload) {
    case SplatPayload::Index:
      return kIota + (target.payloadBase + place);
    case SplatPayload::Colour:
      return colour;
    default:
      return (kIota & 0u) + target.payloadBase;
  }
}

/// Nearest wins; one definition for both pixel types. Stored without a branch: which of two dots is nearer
/// is a coin toss that no predictor learns (a branch takes 1.8 times as long).
template <class Pixel>
ALIDADE_LENS_INLINE void put(Pixel* pixel, Pixel value) {
  const Pixel old = *pixel;
  *pixel = value < old ? value : old;
}

template <bool packed>
ALIDADE_LENS_INLINE void put(const SplatTarget& target, std::size_t at, std::uint32_t depth,
                             std::uint32_t payload) {
  if constexpr (packed) {
    put(target.packed + at, static_cast<std::uint64_t>(depth) << 32 | payload);
  } else {
    put(target.depth + at, depth);
  }
}

/// Where in its pixel a point fell, as PlaceInPixel reads it; u and v half a pixel on, so that floors name
/// the pixel. Means nothing for lanes outside the picture.
ALIDADE_LENS_INLINE Words placeInPixel(const Floats& u, const Floats& v, const Ints& column,
                                       const Ints& row) {
  const Floats inU = u - __builtin_convertvector(column, Floats),
               inV = v - __builtin_convertvector(row, Floats);
  const Ints code =
      __builtin_convertvector(64.0f * inU, Ints) * 64 + __builtin_convertvector(64.0f * inV, Ints);
  return reinterpret_cast<Words>(code);
}

}  // namespace
}  // namespace alidade

#include "raster/splat_queue.h"

namespace alidade {
namespace {

/// A footprint's inverse depth over the picture: linear there, as a plane's is but for what the lens bends it
/// within a few pixels. It ends where its depth leaves the point's by more than half its width in the world,
/// so that a surface seen at a grazing angle is not fattened; its middle pixel stays.
struct Tilt {
  float inverse = 0, alongU = 0, alongV = 0;
  float least = 0, most = 0;
  bool flat = true;  ///< of one depth
};

/// The plane through a point with normal n, n·P = d: 1/z = n·(x, y, 1) / d over undistorted x, y. `du`, `dv`:
/// how u and v change with x and with y.
ALIDADE_LENS_INLINE Tilt tiltOf(const SplatView& view, const float* normal, float x, float y, float z,
                                float size, const float* du, const float* dv) {
  Tilt tilt;
  const float facing = normal[0] * x + normal[1] * y + normal[2];
  const float determinant = du[0] * dv[1] - du[1] * dv[0];
  // Without a normal, or seen along the surface, there is no plane to follow.
  if (!(std::fabs(facing) > 1e-3f) || !(std::fabs(determinant) > 1e-6f)) return tilt;
  tilt.inverse = 1.0f / z;
  const float scale = tilt.inverse / (facing * determinant);
  tilt.alongU = (normal[0] * dv[1] - normal[1] * dv[0]) * scale;
  tilt.alongV = (normal[1] * du[0] - normal[0] * du[1]) * scale;
  const float halfWidth = 0.5f * size / view.fx;  // of the depth
  tilt.least = tilt.inverse / (1.0f + halfWidth);
  tilt.most = halfWidth < 0.9f ? tilt.inverse / (1.0f - halfWidth) : 10.0f * tilt.inverse;
  tilt.flat = false;
  return tilt;
}

/// The pixels whose centres lie within `size` of the point: a square, or a disc within it.
template <bool packed>
void drawFootprint(const SplatView& view, float u, float v, float size, float z, const Tilt& tilt,
                   std::uint32_t payload, const SplatTarget& target) {
  const float half = 0.5f * size;
  const int left = static_cast<int>(std::floor(u - half)) + 1, right = static_cast<int>(std::floor(u + half));
  const int top = static_cast<int>(std::floor(v - half)) + 1, bottom = static_cast<int>(std::floor(v + half));
  const int x0 = left < 0 ? 0 : left, x1 = right < view.width ? right : view.width - 1;
  const int y0 = top < 0 ? 0 : top, y1 = bottom < view.height ? bottom : view.height - 1;
  const int middleX = static_cast<int>(std::floor(u + 0.5f)),
            middleY = static_cast<int>(std::floor(v + 0.5f));
  // A disc of two pixels and less is its square, else it could miss every centre.
  const float radiusSquared = view.round && size > 2.0f ? half * half : size * size;
  for (int y = y0; y <= y1; ++y) {
    const float dy = static_cast<float>(y) - v;
    for (int x = x0; x <= x1; ++x) {
      const float dx = static_cast<float>(x) - u;
      if (dx * dx + dy * dy > radiusSquared) continue;
      float depth = z;
      if (!tilt.flat) {
        float inverse = tilt.inverse + (tilt.alongU * dx + tilt.alongV * dy);
        const bool beyond = inverse < tilt.least || inverse > tilt.most;
        if (beyond && (x != middleX || y != middleY)) continue;
        inverse = inverse < tilt.least ? tilt.least : inverse > tilt.most ? tilt.most : inverse;
        depth = 1.0f / inverse;
      }
      std::uint32_t bits;
      std::memcpy(&bits, &depth, sizeof bits);
      put<packed>(target, static_cast<std::size_t>(y) * view.width + x, bits, payload);
    }
  }
}

template <LensKind kind, bool packed>
ALIDADE_LENS_INLINE void drawFootprints(const SplatView& view, const Projected& p, const SplatTarget& target,
                                        std::uint32_t place) {
  const Floats zero = {};
  const Floats wanted = view.sizeTimesDepth / p.z;
  const Floats atMost = wanted < view.largest ? wanted : (zero + view.largest);
  const Floats size = atMost > view.smallest ? atMost : (zero + view.smallest);
  const Floats half = 0.5f * size;
  const Ints reaches = p.valid & (p.u + half > -0.5f) & (p.u - half < view.width - 0.5f) &
                       (p.v + half > -0.5f) & (p.v - half < view.height - 0.5f);
  const Words payload = payloadOf(target, place, p.colour);
  // How the lens moves a pixel for a small step in x and in y; larger far out, where a fisheye squeezes it.
  Floats ux = zero, vx = zero, uy = zero, vy = zero;
  if (view.cellNormals) {
    const Floats step = 0.01f * (1.0f + (p.x * p.x + p.y * p.y));
    const Floats perStep = 1.0f / step;
    Floats xd, yd;
    distort<kind>(view.lens, Floats(p.x + step), p.y, xd, yd);
    ux = (view.fx * xd + view.cx - p.u) * perStep;
    vx = (view.fy * yd + view.cy - p.v) * perStep;
    distort<kind>(view.lens, p.x, Floats(p.y + step), xd, yd);
    uy = (view.fx * xd + view.cx - p.u) * perStep;
    vy = (view.fy * yd + view.cy - p.v) * perStep;
  }
  for (int i = 0; i < kLanes; ++i) {
    if (!reaches[i]) continue;
    Tilt tilt;
    if (view.cellNormals && size[i] > 1.0f) {
      const float du[2] = {ux[i], uy[i]}, dv[2] = {vx[i], vy[i]};
      tilt = tiltOf(view, view.cellNormals + 3 * p.cell[i], p.x[i], p.y[i], p.z[i], size[i], du, dv);
    }
    drawFootprint<packed>(view, p.u[i], p.v[i], size[i], p.z[i], tilt, payload[i], target);
  }
}

template <LensKind kind, bool packed, bool onePixel>
void drawRun(const SplatView& view, const std::uint16_t* points, std::uint32_t count,
             const SplatTarget& target) {
  PixelQueue<packed> queue(target);
  const auto drawLanes = [&](const Projected& p, std::uint32_t place) __attribute__((always_inline)) {
    if constexpr (onePixel) {
      drawPixels<packed>(view, p, queue, target, place);
    } else {
      drawFootprints<kind, packed>(view, p, target, place);
    }
  };
  std::uint32_t place = 0;
  for (; place + kLanes <= count; place += kLanes) {
    __builtin_prefetch(points + 4 * (place + 16 * kLanes));
    drawLanes(project<kind>(view, points + 4 * place), place);
  }
  if (place == count) return;
  std::uint16_t rest[4 * kLanes] = {};
  std::memcpy(rest, points + 4 * place, (count - place) * 4 * sizeof(std::uint16_t));
  Projected p = project<kind>(view, rest);
  p.valid &= kIota < (count - place);
  drawLanes(p, place);
}

template <LensKind kind>
void drawKind(const SplatView& view, const std::uint16_t* points, std::uint32_t count,
              const SplatTarget& target) {
  if (target.payload == SplatPayload::None) {
    (view.onePixel ? drawRun<kind, false, true> : drawRun<kind, false, false>)(view, points, count, target);
  } else {
    (view.onePixel ? drawRun<kind, true, true> : drawRun<kind, true, false>)(view, points, count, target);
  }
}

void draw(const SplatView& view, const std::uint16_t* points, std::uint32_t count,
          const SplatTarget& target) {
  switch (view.lens.kind) {
    case LensKind::None:
      return drawKind<LensKind::None>(view, points, count, target);
    case LensKind::Radial:
      return drawKind<LensKind::Radial>(view, points, count, target);
    case LensKind::Brown:
      return drawKind<LensKind::Brown>(view, points, count, target);
    case LensKind::Full:
      return drawKind<LensKind::Full>(view, points, count, target);
    case LensKind::Fisheye:
      return drawKind<LensKind::Fisheye>(view, points, count, target);
  }
}

}  // namespace
}  // namespace alidade
