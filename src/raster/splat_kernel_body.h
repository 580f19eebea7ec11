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
#include "raster/splat_plane.h"

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
  Floats inverse;  ///< 1/z
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
  p.inverse = inverse;
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
  target.touched[at >> SplatPlane::kPieceBits] = 1;
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

#include "raster/splat_footprint.h"
#include "raster/splat_level_kernel.h"

namespace alidade {
namespace {

enum class Dots { OnePixel, Levels, Footprints };

template <LensKind kind, bool packed, Dots dots>
void drawRun(const SplatView& view, const std::uint16_t* points, std::uint32_t count,
             const SplatTarget& target) {
  PixelQueue<packed> queue(target);
  const auto drawLanes = [&](const Projected& p, std::uint32_t place) __attribute__((always_inline)) {
    if constexpr (dots == Dots::OnePixel) {
      drawPixels<packed>(view, p, queue, target, place);
    } else if constexpr (dots == Dots::Levels) {
      drawLevels<packed>(view, p, queue, target, place);
    } else {
      drawFootprints<kind, packed>(view, p, queue, target, place);
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

template <LensKind kind, bool packed>
void drawDots(const SplatView& view, const std::uint16_t* points, std::uint32_t count, const SplatTarget& target) {
  if (view.onePixel) return drawRun<kind, packed, Dots::OnePixel>(view, points, count, target);
  if (view.levels) return drawRun<kind, packed, Dots::Levels>(view, points, count, target);
  drawRun<kind, packed, Dots::Footprints>(view, points, count, target);
}

template <LensKind kind>
void drawKind(const SplatView& view, const std::uint16_t* points, std::uint32_t count,
              const SplatTarget& target) {
  (target.payload == SplatPayload::None ? drawDots<kind, false> : drawDots<kind, true>)(view, points, count, target);
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
