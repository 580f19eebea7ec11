// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of more than one pixel, included by splat_kernel_body.h.
//
// Small footprints are drawn side by side: all lanes' first pixel, all lanes' second pixel and so on, each step like a
// vector of one-pixel points. Wide ones are drawn one after another, a row of pixels at a time.

namespace alidade {
namespace {

/// How much a footprint bends, as a part of its depth at its own width from the point.
constexpr float kBend = 0.0005f;
/// The same, as a part of half its width, where no plane is known: a dome, that shows where nothing better does. A square that
/// faced the eye would stand out of the surface.
constexpr float kDome = 0.4f;
/// Wider footprints are drawn row by row.
constexpr int kSideBySide = 4;
/// Footprints of so many pixels and less are of one depth: a plane would change it by no more than a point of one pixel is off.
constexpr float kFlat = 2.0f;

/// A footprint's depth over the picture: 1 + t is how many times its point's inverse depth it has there, and t is linear, as a
/// plane's is but for what the lens bends it within a few pixels. It ends where its depth leaves the point's by more than
/// half its width in the world, so that a surface seen at a grazing angle is not fattened; its middle pixel stays. It bends
/// away from the eye a little towards its border, so that of neighbours in one plane each has the pixels nearest to it.
///
/// T: Floats for a lane each, float for one.
template <class T>
struct Tilt {
  T alongU, alongV;  ///< of t, a pixel
  T bend;            ///< that t loses with the squared distance from the point, a pixel²
  T least, most;     ///< of t
};

/// The pixels whose centres lie within `size` of each point: a square, or a disc within it.
struct Footprints {
  Ints left, top, columns, rows;  ///< within the picture; columns or rows < 1: none
  Ints middleX, middleY;
  Floats radiusSquared;
  Tilt<Floats> tilt;
  Ints flat;  ///< of one depth
};

ALIDADE_LENS_INLINE Floats gatherFloats(const float* from, const Ints& at) {
#if ALIDADE_SPLAT_LANES == 16
  return _mm512_i32gather_ps(reinterpret_cast<__m512i>(at), from, 4);
#elif ALIDADE_SPLAT_LANES == 8
  return _mm256_i32gather_ps(from, reinterpret_cast<__m256i>(at), 4);
#else
  Floats values;
  for (int i = 0; i < kLanes; ++i) values[i] = from[at[i]];
  return values;
#endif
}

/// Half its width as a part of the depth, in the tilt's own bounds.
ALIDADE_LENS_INLINE Floats halfWidthOf(const SplatView& view, const Floats& size) {
  const Floats half = size * (0.5f / view.fx);
  return half < 0.3f ? half : Floats{} + 0.3f;
}

/// The plane through a point with normal n, n·P = d: 1/z = n·(x, y, 1) / d over undistorted x, y. Without a
/// normal, or seen along the surface, there is no plane to follow, and the footprint is a dome.
template <LensKind kind>
ALIDADE_LENS_INLINE void layOnSurface(const SplatView& view, const Projected& p, const Floats& size, Footprints& f) {
  // How the lens moves a pixel for a small step in x and in y; larger far out, where a fisheye squeezes it.
  const Floats step = 0.01f * (1.0f + (p.x * p.x + p.y * p.y));
  const Floats perStep = 1.0f / step;
  Floats xd, yd;
  distort<kind>(view.lens, Floats(p.x + step), p.y, xd, yd);
  const Floats ux = (view.fx * xd + view.cx - p.u) * perStep, vx = (view.fy * yd + view.cy - p.v) * perStep;
  distort<kind>(view.lens, p.x, Floats(p.y + step), xd, yd);
  const Floats uy = (view.fx * xd + view.cx - p.u) * perStep, vy = (view.fy * yd + view.cy - p.v) * perStep;

  const Ints at = 4 * p.cell;
  const Floats nx = gatherFloats(view.cellNormals, at), ny = gatherFloats(view.cellNormals + 1, at),
               nz = gatherFloats(view.cellNormals + 2, at);
  const Floats facing = nx * p.x + ny * p.y + nz;
  const Floats determinant = ux * vy - uy * vx;
  const Ints hasPlane = ((facing > 1e-3f) | (facing < -1e-3f)) & ((determinant > 1e-6f) | (determinant < -1e-6f));
  f.flat = ~(size > kFlat);
  const Floats h = halfWidthOf(view, size), zero = {};
  const Floats scale = 1.0f / (facing * determinant);
  f.tilt.alongU = hasPlane ? (nx * vy - ny * vx) * scale : zero;
  f.tilt.alongV = hasPlane ? (ny * ux - nx * uy) * scale : zero;
  f.tilt.bend = (hasPlane ? zero + kBend : 4.0f * kDome * h) / (size * size);
  // t from 1 / (1 + h) - 1 to 1 / (1 - h) - 1, but for cubes.
  f.tilt.least = h * (h - 1.0f);
  f.tilt.most = h * (h + 1.0f);
}

ALIDADE_LENS_INLINE Floats magnitude(const Floats& value) {
  return reinterpret_cast<Floats>(reinterpret_cast<Words>(value) & 0x7fffffffu);  // of -0, too
}

/// What t owes to a distance along one axis.
template <class T>
ALIDADE_LENS_INLINE Floats along(const T& slope, const T& bend, const Floats& distance) {
  return distance * (slope - bend * distance);
}

/// The depth of one pixel of each footprint; false where it has none there. z / (1 + t), without its cube and
/// what is smaller: a division would take most of the time.
template <class T>
ALIDADE_LENS_INLINE Ints depthAt(const Tilt<T>& tilt, const Floats& z, const Floats& free, const Ints& middle, Floats& depth) {
  const Floats least = Floats{} + tilt.least, most = Floats{} + tilt.most;
  const Floats above = free > least ? free : least;
  const Floats t = above < most ? above : most;
  depth = z * (1.0f - t * (1.0f - t));
  return (t == free) | middle;
}

template <bool packed>
ALIDADE_LENS_INLINE void drawSideBySide(const SplatView& view, const Projected& p, const Footprints& f, const Ints& chosen,
                                        const Words& payload, PixelQueue<packed>& queue) {
  const bool allFlat = lanesOf(chosen & ~f.flat) == 0;
  for (int j = 0;; ++j) {
    const Ints inRows = chosen & (f.rows > j);
    if (lanesOf(inRows) == 0) break;
    const Ints y = f.top + j;
    const Floats dy = __builtin_convertvector(y, Floats) - p.v;
    const Floats alongColumn = along(f.tilt.alongV, f.tilt.bend, dy);
    const Ints isMiddleY = y == f.middleY;
    for (int i = 0;; ++i) {
      Ints inside = inRows & (f.columns > i);
      if (lanesOf(inside) == 0) break;
      const Ints x = f.left + i;
      const Floats dx = __builtin_convertvector(x, Floats) - p.u;
      if (view.round) inside &= ~(dx * dx + dy * dy > f.radiusSquared);
      Floats depth = p.z;
      if (!allFlat) {
        Floats tilted;
        inside &= depthAt(f.tilt, p.z, Floats(along(f.tilt.alongU, f.tilt.bend, dx) + alongColumn), Ints((x == f.middleX) & isMiddleY), tilted) | f.flat;
        depth = f.flat ? p.z : tilted;
      }
      const Ints at = y * view.width + x;
      const Words bits = reinterpret_cast<Words>(depth);
      queue.add(lanesOf(inside), at, bits, payload);
    }
  }
}

#if ALIDADE_SPLAT_LANES == 16

/// Nearest wins in the chosen of eight pixels side by side.
ALIDADE_LENS_INLINE void putEight(std::uint64_t* pixels, __mmask8 chosen, const __m512i& value) {
  _mm512_mask_storeu_epi64(pixels, chosen, _mm512_min_epu64(_mm512_maskz_loadu_epi64(chosen, pixels), value));
}
ALIDADE_LENS_INLINE void putEight(std::uint32_t* pixels, __mmask8 chosen, const __m256i& value) {
  _mm256_mask_storeu_epi32(pixels, chosen, _mm256_min_epu32(_mm256_maskz_loadu_epi32(chosen, pixels), value));
}

/// The chosen pixels from `at` on lie in two pieces at most.
ALIDADE_LENS_INLINE void touch(const SplatTarget& target, std::size_t at, __mmask8 chosen) {
  if (chosen == 0) return;
  target.touched[(at + static_cast<unsigned>(__builtin_ctz(chosen))) >> SplatPlane::kPieceBits] = 1;
  target.touched[(at + 31 - static_cast<unsigned>(__builtin_clz(chosen))) >> SplatPlane::kPieceBits] = 1;
}

/// The first eight lanes' pixels from `at` on, the others' from `then` on.
template <bool packed>
ALIDADE_LENS_INLINE void putLanes(const SplatTarget& target, std::size_t at, std::size_t then, Lanes chosen, const Words& depth,
                                  std::uint32_t payload) {
  const __m512i bits = reinterpret_cast<__m512i>(depth);
  const auto first = static_cast<__mmask8>(chosen), second = static_cast<__mmask8>(chosen >> 8);
  touch(target, at, first);
  touch(target, then, second);
  if constexpr (packed) {
    // The payload below each depth.
    const __m512i low = _mm512_setr_epi32(16, 0, 16, 1, 16, 2, 16, 3, 16, 4, 16, 5, 16, 6, 16, 7);
    const __m512i high = _mm512_setr_epi32(16, 8, 16, 9, 16, 10, 16, 11, 16, 12, 16, 13, 16, 14, 16, 15);
    const __m512i below = _mm512_set1_epi32(static_cast<int>(payload));
    putEight(target.packed + at, first, _mm512_permutex2var_epi32(bits, low, below));
    putEight(target.packed + then, second, _mm512_permutex2var_epi32(bits, high, below));
  } else {
    putEight(target.depth + at, first, _mm512_castsi512_si256(bits));
    putEight(target.depth + then, second, _mm512_extracti64x4_epi64(bits, 1));
  }
}

#else

template <bool packed>
ALIDADE_LENS_INLINE void putLanes(const SplatTarget& target, std::size_t at, std::size_t, Lanes chosen, const Words& depth,
                                  std::uint32_t payload) {
  for (int i = 0; i < kLanes; ++i)
    if (chosen >> i & 1) put<packed>(target, at + static_cast<std::size_t>(i), depth[i], payload);
}

#endif

/// One lane's footprint: `kColumns` pixels of a row at a time, and as many rows as that leaves lanes for.
template <bool packed, int kColumns>
ALIDADE_LENS_INLINE void drawRows(const SplatView& view, const Projected& p, const Footprints& f, int lane,
                                  std::uint32_t payload, const SplatTarget& target) {
  constexpr int kRows = kLanes / kColumns;
  const Ints iota = reinterpret_cast<Ints>(kIota);
  const Ints inRow = iota % kColumns, ofRow = iota / kColumns;
  const float u = p.u[lane], v = p.v[lane], radiusSquared = f.radiusSquared[lane];
  const int left = f.left[lane], top = f.top[lane], columns = f.columns[lane], rows = f.rows[lane];
  const int middleX = f.middleX[lane], middleY = f.middleY[lane];
  const bool flat = f.flat[lane] != 0;
  const Tilt<float> tilt{f.tilt.alongU[lane], f.tilt.alongV[lane], f.tilt.bend[lane], f.tilt.least[lane], f.tilt.most[lane]};
  const Floats z = Floats{} + p.z[lane];
  const auto width = static_cast<std::size_t>(view.width);
  for (int first = 0; first < columns; first += kColumns) {
    const Ints column = inRow + first, x = column + left;
    const Ints inColumns = column < columns, isMiddleX = x == middleX;
    const Floats dx = __builtin_convertvector(x, Floats) - u;
    const Floats alongRow = along(tilt.alongU, tilt.bend, dx);
    std::size_t at = static_cast<std::size_t>(top) * width + static_cast<std::size_t>(left + first);
    for (int row = 0; row < rows; row += kRows, at += kRows * width) {
      const Ints y = ofRow + (top + row);
      const Floats dy = __builtin_convertvector(y, Floats) - v;
      Ints inside = inColumns;
      if (kRows > 1) inside &= y < top + rows;
      if (view.round) inside &= ~(dx * dx + dy * dy > radiusSquared);
      Floats depth = z;
      if (!flat) inside &= depthAt(tilt, z, Floats(alongRow + along(tilt.alongV, tilt.bend, dy)), Ints(isMiddleX & (y == middleY)), depth);
      putLanes<packed>(target, at, at + (kRows > 1 ? width : 8), lanesOf(inside), reinterpret_cast<Words>(depth), payload);
    }
  }
}

template <LensKind kind, bool packed>
ALIDADE_LENS_INLINE void drawFootprints(const SplatView& view, const Projected& p, PixelQueue<packed>& queue,
                                        const SplatTarget& target, std::uint32_t place) {
  const Floats zero = {};
  Floats widening = zero + 1.0f;
  if (view.cellNormals) widening = gatherFloats(view.cellNormals + 3, Ints(4 * p.cell));
  const Floats wanted = view.sizeTimesDepth * widening * p.inverse - view.sizeLess;
  const Floats atMost = wanted < view.largest ? wanted : (zero + view.largest);
  const Floats size = atMost > view.smallest ? atMost : (zero + view.smallest);
  const Floats half = 0.5f * size;
  const Ints reaches = p.valid & (p.u + half > -0.5f) & (p.u - half < view.width - 0.5f) &
                       (p.v + half > -0.5f) & (p.v - half < view.height - 0.5f);
  if (lanesOf(reaches) == 0) return;
  Footprints f;
  f.flat = ~Ints{};
  f.tilt = Tilt<Floats>{};
  Floats halfU = half, halfV = half;
  if (view.cellNormals && lanesOf(reaches & (size > kFlat)) != 0) {
    layOnSurface<kind>(view, p, size, f);
    // Where t is sure to leave its bounds there is nothing to look at: most of a floor's squares at a grazing angle.
    const Floats slopeU = magnitude(f.tilt.alongU), slopeV = magnitude(f.tilt.alongV);
    const Floats reachU = 1.0f + (f.tilt.most + slopeV * half) * 1.01f / slopeU, reachV = 1.0f + (f.tilt.most + slopeU * half) * 1.01f / slopeV;
    halfU = ~f.flat & (reachU < half) ? reachU : half;
    halfV = ~f.flat & (reachV < half) ? reachV : half;
  }
  const Ints left = floorOf(p.u - halfU) + 1, top = floorOf(p.v - halfV) + 1;
  f.left = left < 0 ? Ints{} : left;
  f.top = top < 0 ? Ints{} : top;
  const Ints right = floorOf(p.u + halfU), bottom = floorOf(p.v + halfV);
  f.columns = (right < view.width ? right + 1 : Ints{} + view.width) - f.left;
  f.rows = (bottom < view.height ? bottom + 1 : Ints{} + view.height) - f.top;
  f.middleX = floorOf(p.u + 0.5f);
  f.middleY = floorOf(p.v + 0.5f);
  // A disc of two pixels and less is its square, else it could miss every centre.
  f.radiusSquared = size * size;
  if (view.round) f.radiusSquared = size > 2.0f ? half * half : f.radiusSquared;
  const Words payload = payloadOf(target, place, p.colour);
  const Ints wide = reaches & ((f.columns > kSideBySide) | (f.rows > kSideBySide));
  drawSideBySide<packed>(view, p, f, Ints(reaches & ~wide), payload, queue);
  for (Lanes waiting = lanesOf(wide); waiting != 0; waiting &= static_cast<Lanes>(waiting - 1)) {
    const int lane = __builtin_ctz(waiting);
    if (kLanes > 8 && f.columns[lane] <= 8) {
      drawRows<packed, kLanes < 8 ? kLanes : 8>(view, p, f, lane, payload[lane], target);
    } else {
      drawRows<packed, kLanes>(view, p, f, lane, payload[lane], target);
    }
  }
}

}  // namespace
}  // namespace alidade
