// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Rows of surfaces, written once in GCC's vector extension and included by one .cpp for each instruction set, which
// defines ALIDADE_SURFACE_LANES. Everything here has internal linkage.

#include <bit>
#include <cstring>

#if defined(__SSE__)
#include <immintrin.h>
#endif

#include "raster/splat_levels.h"
#include "raster/surface_kernel.h"

#define ALIDADE_SURFACE_INLINE inline __attribute__((always_inline))

namespace alidade {
namespace {

constexpr std::size_t kLanes = ALIDADE_SURFACE_LANES;
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * kLanes)));

#if ALIDADE_SURFACE_LANES == 16
#define ALIDADE_EVEN 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30
#define ALIDADE_ODD 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31
#define ALIDADE_LOWER 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23
#define ALIDADE_UPPER 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31
#elif ALIDADE_SURFACE_LANES == 8
#define ALIDADE_EVEN 0, 2, 4, 6, 8, 10, 12, 14
#define ALIDADE_ODD 1, 3, 5, 7, 9, 11, 13, 15
#define ALIDADE_LOWER 0, 8, 1, 9, 2, 10, 3, 11
#define ALIDADE_UPPER 4, 12, 5, 13, 6, 14, 7, 15
#else
#define ALIDADE_EVEN 0, 2, 4, 6
#define ALIDADE_ODD 1, 3, 5, 7
#define ALIDADE_LOWER 0, 4, 1, 5
#define ALIDADE_UPPER 2, 6, 3, 7
#endif

/// Neighbouring cells of a coarse surface whose inverse depths differ by less, as a part, are of one surface.
constexpr float kOneSurface = 0.1f;
/// By so much a slope that is seen at a grazing angle may change from cell to cell.
constexpr float kSteepest = 0.3f;
/// A point is of the surface around it if it lies no farther behind its farthest cell than by this part, for the scan's noise, and by
/// half of what the cells differ, for their slope: the other side of a thin wall lies farther.
constexpr float kNoise = 1.005f, kSlope = 0.5f;
/// Neighbouring cells' depths that differ by less are of one surface.
constexpr float kBehind = 1.03f;

ALIDADE_SURFACE_INLINE Floats load(const float* from) {
  Floats values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
ALIDADE_SURFACE_INLINE Words load(const std::uint32_t* from) {
  Words values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
ALIDADE_SURFACE_INLINE void store(const Floats& values, float* to) {
  std::memcpy(to, &values, sizeof values);
}
ALIDADE_SURFACE_INLINE void store(const Words& values, std::uint32_t* to) {
  std::memcpy(to, &values, sizeof values);
}
/// even[0], odd[0], even[1], odd[1] ...
template <class Vector>
struct InTurn {
  Vector lower, upper;
  ALIDADE_SURFACE_INLINE InTurn(const Vector& even, const Vector& odd)
      : lower(__builtin_shufflevector(even, odd, ALIDADE_LOWER)), upper(__builtin_shufflevector(even, odd, ALIDADE_UPPER)) {}
};

ALIDADE_SURFACE_INLINE bool anyOf(const Ints& mask) {
#if ALIDADE_SURFACE_LANES == 16
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask)) != 0;
#elif ALIDADE_SURFACE_LANES == 8
  return _mm256_movemask_ps(reinterpret_cast<__m256>(mask)) != 0;
#else
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
#endif
}

ALIDADE_SURFACE_INLINE Floats smaller(const Floats& a, const Floats& b) {
  return a < b ? a : b;
}
ALIDADE_SURFACE_INLINE Floats larger(const Floats& a, const Floats& b) {
  return a > b ? a : b;
}

/// Inverse depth of the farthest point that is of a surface whose cells lie between `least` and `most`.
ALIDADE_SURFACE_INLINE Floats leastOf(const Floats& least, const Floats& most) {
  return (least - kSlope * (most - least)) * (1.0f / kNoise);
}

void takeDepths(const std::uint32_t* pixels, std::size_t count, float* inverse) {
  for (std::size_t i = 0; i < count; ++i) {
    const float z = std::bit_cast<float>(pixels[i]);  // all ones is a NaN
    inverse[i] = pixels[i] == 0xffffffffu ? 0.0f : 1.0f / z;
  }
}

void takePixels(const std::uint64_t* pixels, std::size_t count, const SurfaceRow& row) {
  float* inverse = row.inverse;
  std::uint32_t* payload = row.payload;
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = static_cast<std::uint32_t>(pixels[i] >> 32);
    inverse[i] = bits == 0xffffffffu ? 0.0f : 1.0f / std::bit_cast<float>(bits);
  }
  if (!payload) return;
  for (std::size_t i = 0; i < count; ++i) payload[i] = static_cast<std::uint32_t>(pixels[i]);
}

void takeColours(const std::uint64_t* pixels, std::size_t count, const SurfaceRow& row) {
  float* inverse = row.inverse;
  std::uint32_t* payload = row.payload;
  for (std::size_t i = 0; i < count; ++i) {
    const auto bits = static_cast<std::uint32_t>(pixels[i] >> 32), rgb565 = static_cast<std::uint32_t>(pixels[i]);
    inverse[i] = bits == 0xffffffffu ? 0.0f : 1.0f / std::bit_cast<float>(bits);
    const std::uint32_t r = rgb565 >> 11 & 31, g = rgb565 >> 5 & 63, b = rgb565 & 31;
    payload[i] = 0xff000000u | (b << 3 | b >> 2) << 16 | (g << 2 | g >> 4) << 8 | (r << 3 | r >> 2);
  }
}

/// Which neighbours are of a cell's surface.
ALIDADE_SURFACE_INLINE Ints isLike(const Floats& own, const Floats& other) {
  return larger(own, other) - smaller(own, other) <= kOneSurface * own;
}

void takePlaces(const std::uint64_t* pixels, std::size_t count, std::uint32_t* places) {
  for (std::size_t i = 0; i < count; ++i) places[i] = static_cast<std::uint32_t>(pixels[i]) >> PlaceInCell::kColourBits;
}

/// Cells from the middle.
ALIDADE_SURFACE_INLINE Floats placeOf(const Words& places, int axis) {
  return (__builtin_convertvector(Ints(places >> (8 * axis) & 255u), Floats) + 0.5f) * (1.0f / PlaceInCell::kSteps) - 0.5f;
}

/// Along one axis to the neighbour on one side of it, -1 or 1 cells away; 0 where that is bare or of another surface.
ALIDADE_SURFACE_INLINE Floats slopeTo(const Floats& own, const Floats& place, const float* inverse, const std::uint32_t* places, int axis, float side) {
  const Floats other = load(inverse);
  const Floats apart = 1.0f + side * (placeOf(load(places), axis) - place);
  const Floats least = Floats{} + 0.25f;  // two points side by side tell no slope
  const Floats slope = side * (other - own) / (apart > least ? apart : least);
  return larger(own, other) - smaller(own, other) <= kSteepest * own ? slope : Floats{};
}

ALIDADE_SURFACE_INLINE Floats lesserSlope(const Floats& a, const Floats& b) {
  const Ints isRising = (a > 0.0f) & (b > 0.0f), isFalling = (a < 0.0f) & (b < 0.0f);
  return isRising ? smaller(a, b) : isFalling ? larger(a, b) : Floats{};
}

void toMiddles(const SurfaceCells (&rows)[3], std::size_t count, float* inverse) {
  const SurfaceCells &above = rows[0], &middle = rows[1], &below = rows[2];
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats own = load(middle.inverse + i);
    const Words places = load(middle.payload + i);
    const Floats u = placeOf(places, 0), v = placeOf(places, 1);
    const Floats alongU = lesserSlope(slopeTo(own, u, middle.inverse + i - 1, middle.payload + i - 1, 0, -1.0f), slopeTo(own, u, middle.inverse + i + 1, middle.payload + i + 1, 0, 1.0f));
    const Floats alongV = lesserSlope(slopeTo(own, v, above.inverse + i, above.payload + i, 1, -1.0f), slopeTo(own, v, below.inverse + i, below.payload + i, 1, 1.0f));
    store(Floats(own - (alongU * u + alongV * v)), inverse + i);
  }
}

template <bool hasPayload>
void pullCells(const SurfaceCells& finer, std::size_t count, const SurfaceRow& row) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats own = load(row.inverse + i), low = load(finer.inverse + 2 * i), high = load(finer.inverse + 2 * i + kLanes);
    const Floats even = __builtin_shufflevector(low, high, ALIDADE_EVEN), odd = __builtin_shufflevector(low, high, ALIDADE_ODD);
    const Ints isOdd = odd > even;
    const Floats nearest = isOdd ? odd : even;
    const Ints isFiner = nearest > own;
    store(Floats(isFiner ? nearest : own), row.inverse + i);
    if constexpr (hasPayload) {
      const Words lowPayload = load(finer.payload + 2 * i), highPayload = load(finer.payload + 2 * i + kLanes);
      const Words evenPayload = __builtin_shufflevector(lowPayload, highPayload, ALIDADE_EVEN), oddPayload = __builtin_shufflevector(lowPayload, highPayload, ALIDADE_ODD);
      const Words payload = isOdd ? oddPayload : evenPayload;
      store(Words(isFiner ? payload : load(row.payload + i)), row.payload + i);
    }
  }
}

void pull(const SurfaceCells& finer, std::size_t count, const SurfaceRow& row) {
  (row.payload ? pullCells<true> : pullCells<false>)(finer, count, row);
}

void takeNearer(const SurfaceCells& a, const SurfaceCells& b, std::size_t count, const SurfaceRow& row) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats first = load(a.inverse + i), second = load(b.inverse + i);
    const Ints isSecond = second > first;
    store(Floats(isSecond ? second : first), row.inverse + i);
    if (row.payload) store(Words(isSecond ? load(b.payload + i) : load(a.payload + i)), row.payload + i);
  }
}

ALIDADE_SURFACE_INLINE Words blended(const Words& own, const Words& beside, const Words& across, const Words& corner) {
  const Words low = 9 * (own & 0x00ff00ffu) + 3 * ((beside & 0x00ff00ffu) + (across & 0x00ff00ffu)) + (corner & 0x00ff00ffu) + 0x00080008u;
  const Words high = 9 * (own >> 8 & 0x00ff00ffu) + 3 * ((beside >> 8 & 0x00ff00ffu) + (across >> 8 & 0x00ff00ffu)) + (corner >> 8 & 0x00ff00ffu) + 0x00080008u;
  return (low >> 4 & 0x00ff00ffu) | (high >> 4 & 0x00ff00ffu) << 8;
}

struct Quarter {
  Floats inverse;
  Floats least;  ///< of the points that are of the surface there
  Words payload;
};

template <bool hasPayload>
ALIDADE_SURFACE_INLINE Quarter quarterOf(const SurfaceCells& ownRow, const SurfaceCells& acrossRow, std::size_t at, std::size_t beside, std::size_t opposite, bool blends) {
  const Floats a = load(ownRow.inverse + at), b = load(ownRow.inverse + beside);
  const Floats c = load(acrossRow.inverse + at), d = load(acrossRow.inverse + beside);
  const Ints likeB = isLike(a, b), likeC = isLike(a, c), likeD = isLike(a, d);
  const Floats between = (9.0f * a + 3.0f * ((likeB ? b : a) + (likeC ? c : a)) + (likeD ? d : a)) * 0.0625f;
  Quarter quarter{};
  const Ints isCorner = ((b + c) + d == 0.0f) & (load(ownRow.inverse + opposite) > 0.0f);
  quarter.inverse = isCorner ? Floats{} : between;
  quarter.least = leastOf(smaller(smaller(a, b), smaller(c, d)), larger(larger(a, b), larger(c, d)));
  if constexpr (hasPayload) {
    const Words own = load(ownRow.payload + at);
    quarter.payload = own;
    if (blends) {
      const Words q = load(ownRow.payload + beside), r = load(acrossRow.payload + at), s = load(acrossRow.payload + beside);
      quarter.payload = blended(own, likeB ? q : own, likeC ? r : own, likeD ? s : own);
    }
  }
  return quarter;
}

template <bool hasPayload>
ALIDADE_SURFACE_INLINE void takeBehind(const Floats& coarser, const Floats& least, const Words& payload, std::size_t at, const SurfaceRow& row) {
  const Floats own = load(row.inverse + at);
  const Ints isSeen = (own > 0.0f) & (own >= least);
  store(Floats(isSeen ? own : coarser), row.inverse + at);
  if constexpr (hasPayload) store(Words(isSeen ? load(row.payload + at) : payload), row.payload + at);
}

template <bool hasPayload>
void takeCoarserCells(const SurfaceCells& own, const SurfaceCells& across, bool blends, std::size_t count, const SurfaceRow& row) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    if (!anyOf(load(own.inverse + i) > 0.0f)) continue;
    const Quarter left = quarterOf<hasPayload>(own, across, i, i - 1, i + 1, blends), right = quarterOf<hasPayload>(own, across, i, i + 1, i - 1, blends);
    const InTurn<Floats> inverse(left.inverse, right.inverse), least(left.least, right.least);
    const InTurn<Words> payload(left.payload, right.payload);
    takeBehind<hasPayload>(inverse.lower, least.lower, payload.lower, 2 * i, row);
    takeBehind<hasPayload>(inverse.upper, least.upper, payload.upper, 2 * i + kLanes, row);
  }
}

void takeCoarser(const SurfaceCells& own, const SurfaceCells& across, bool blends, std::size_t count, const SurfaceRow& row) {
  (row.payload ? takeCoarserCells<true> : takeCoarserCells<false>)(own, across, blends, count, row);
}

/// What faces a hole on one side, of two cells going away from it: the first, unless that is a hole itself.
struct Side {
  Floats inverse;
  Ints isFirst;
};

ALIDADE_SURFACE_INLINE Side sideOf(const float* first, const float* second) {
  const Floats near = load(first), far = load(second);
  const Ints isFirst = kBehind * near >= far;
  return {isFirst ? near : far, isFirst};
}

template <bool hasPayload>
void closeHolesOf(const SurfaceCells (&rows)[5], const SurfaceCells& ownRow, std::size_t count, const SurfaceRow& closed) {
  const SurfaceCells &top = rows[0], &above = rows[1], &middle = rows[2], &below = rows[3], &bottom = rows[4];
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Side left = sideOf(middle.inverse + i - 1, middle.inverse + i - 2), right = sideOf(middle.inverse + i + 1, middle.inverse + i + 2);
    const Side up = sideOf(above.inverse + i, top.inverse + i), down = sideOf(below.inverse + i, bottom.inverse + i);
    const Floats own = load(ownRow.inverse + i), here = load(middle.inverse + i);
    const Floats acrossLeast = smaller(left.inverse, right.inverse), alongLeast = smaller(up.inverse, down.inverse);
    const Floats acrossMost = larger(left.inverse, right.inverse), alongMost = larger(up.inverse, down.inverse);
    const Floats farthest = smaller(acrossLeast, alongLeast);
    const Floats around = leastOf(farthest, larger(acrossMost, alongMost));
    const Ints isHole = (own < around) | ((own == 0.0f) & (farthest > 0.0f)), isHere = (here > 0.0f) & (here >= around);
    if (!anyOf(isHole)) {
      store(own, closed.inverse + i);
      if constexpr (hasPayload) store(load(ownRow.payload + i), closed.payload + i);
      continue;
    }
    // The two whose inverse depths differ by the smaller part.
    const Ints isAcross = (acrossMost - acrossLeast) * alongMost <= (alongMost - alongLeast) * acrossMost;
    const Floats a = isAcross ? left.inverse : up.inverse, b = isAcross ? right.inverse : down.inverse;
    const Floats least = isAcross ? acrossLeast : alongLeast, most = isAcross ? acrossMost : alongMost;
    const Ints aFirst = isAcross ? left.isFirst : up.isFirst, bFirst = isAcross ? right.isFirst : down.isFirst;
    // Of the way from a to b: a half, a third or two thirds.
    const Floats half = Floats{} + 0.5f, third = Floats{} + 1.0f / 3.0f;
    const Floats part = (aFirst & ~bFirst) != 0 ? third : (~aFirst & bFirst) != 0 ? 1.0f - third : half;
    const Ints isEdge = most > kBehind * least;
    const Floats between = isEdge ? least : a + part * (b - a);
    store(Floats(isHole ? (isHere ? here : between) : own), closed.inverse + i);
    if constexpr (hasPayload) {
      const Words sideways = left.isFirst ? load(middle.payload + i - 1) : load(middle.payload + i - 2);
      const Words opposite = right.isFirst ? load(middle.payload + i + 1) : load(middle.payload + i + 2);
      const Words upwards = up.isFirst ? load(above.payload + i) : load(top.payload + i);
      const Words downwards = down.isFirst ? load(below.payload + i) : load(bottom.payload + i);
      const Words first = isAcross ? sideways : upwards, second = isAcross ? opposite : downwards;
      const Ints takesSecond = isEdge ? b < a : ~aFirst & bFirst;
      const Words taken = takesSecond ? second : first;
      store(Words(isHole ? (isHere ? load(middle.payload + i) : taken) : load(ownRow.payload + i)), closed.payload + i);
    }
  }
}

void closeHoles(const SurfaceCells (&rows)[5], const SurfaceCells& own, std::size_t count, const SurfaceRow& closed) {
  (closed.payload ? closeHolesOf<true> : closeHolesOf<false>)(rows, own, count, closed);
}

}  // namespace
}  // namespace alidade
