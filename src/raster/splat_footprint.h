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
/// Wider footprints are drawn row by row.
constexpr float kSideBySide = 4.0f;

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

/// The plane through a point with normal n, n·P = d: 1/z = n·(x, y, 1) / d over undistorted x, y. Without a
/// normal, or seen along the surface, there is no plane to follow.
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
  f.flat = ~((size > 1.0f) & ((facing > 1e-3f) | (facing < -1e-3f)) & ((determinant > 1e-6f) | (determinant < -1e-6f)));
  const Floats scale = 1.0f / (facing * determinant);
  f.tilt.alongU = (nx * vy - ny * vx) * scale;
  f.tilt.alongV = (ny * ux - nx * uy) * scale;
  f.tilt.bend = kBend / (size * size);
  // Half its width as a part of the depth, h: t from 1 / (1 + h) - 1 to 1 / (1 - h) - 1, but for cubes.
  const Floats wide = size * (0.5f / view.fx), h = wide < 0.3f ? wide : Floats{} + 0.3f;
  f.tilt.least = h * (h - 1.0f);
  f.tilt.most = h * (h + 1.0f);
}

/// The depth of one pixel of each footprint; false where it has none there. z / (1 + t), without its fourth power and
/// what is smaller: no division, which would take most of the time.
template <class T, class Mask>
ALIDADE_LENS_INLINE Mask depthAt(const Tilt<T>& tilt, const Floats& z, const Floats& alongRow, const Floats& alongColumn,
                                 const Floats& squaredDistance, const Mask& middle, Floats& depth) {
  const Floats free = (alongRow + alongColumn) - tilt.bend * squaredDistance;
  const Mask near = free > tilt.most, far = free < tilt.least;
  Floats t = near ? Floats{} + tilt.most : free;
  t = far ? Floats{} + tilt.least : t;
  depth = z * ((1.0f - t) * (1.0f + t * t));
  return ~(near | far) | middle;
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
    for (int i = 0;; ++i) {
      Ints inside = inRows & (f.columns > i);
      if (lanesOf(inside) == 0) break;
      const Ints x = f.left + i;
      const Floats dx = __builtin_convertvector(x, Floats) - p.u;
      const Floats squaredDistance = dx * dx + dy * dy;
      inside &= ~(squaredDistance > f.radiusSquared);
      Floats depth = p.z;
      if (!allFlat) {
        Floats tilted;
        const Ints isMiddle = (x == f.middleX) & (y == f.middleY);
        inside &= depthAt(f.tilt, p.z, Floats(f.tilt.alongU * dx), Floats(f.tilt.alongV * dy), squaredDistance, isMiddle,
                                  tilted) | f.flat;
        depth = f.flat ? p.z : tilted;
      }
      const Ints at = y * view.width + x;
      const Words bits = reinterpret_cast<Words>(depth);
      queue.add(queue.candidates(at, bits, lanesOf(inside)), at, bits, payload);
    }
  }
}

/// Nearest wins in the chosen of kLanes pixels side by side.
template <bool packed>
ALIDADE_LENS_INLINE void putRow(const SplatTarget& target, std::size_t at, Lanes chosen, const Words& depth,
                                std::uint32_t payload) {
#if ALIDADE_SPLAT_LANES == 16
  const __m512i bits = reinterpret_cast<__m512i>(depth);
  if constexpr (packed) {
    const __m512i below = _mm512_set1_epi64(payload);
    const auto putHalf = [&](std::uint64_t* pixels, __mmask8 half, __m256i depths) __attribute__((always_inline)) {
      const __m512i value = _mm512_or_si512(_mm512_slli_epi64(_mm512_cvtepu32_epi64(depths), 32), below);
      _mm512_mask_storeu_epi64(pixels, half, _mm512_min_epu64(_mm512_maskz_loadu_epi64(half, pixels), value));
    };
    putHalf(target.packed + at, static_cast<__mmask8>(chosen), _mm512_castsi512_si256(bits));
    if (chosen >> 8) putHalf(target.packed + at + 8, static_cast<__mmask8>(chosen >> 8), _mm512_extracti64x4_epi64(bits, 1));
  } else {
    std::uint32_t* pixels = target.depth + at;
    _mm512_mask_storeu_epi32(pixels, chosen, _mm512_min_epu32(_mm512_maskz_loadu_epi32(chosen, pixels), bits));
  }
#else
  for (int i = 0; i < kLanes; ++i)
    if (chosen >> i & 1) put<packed>(target, at + static_cast<std::size_t>(i), depth[i], payload);
#endif
}

/// One lane's footprint.
template <bool packed>
ALIDADE_LENS_INLINE void drawRows(const SplatView& view, const Projected& p, const Footprints& f, int lane,
                                  std::uint32_t payload, const SplatTarget& target) {
  const float u = p.u[lane], v = p.v[lane], radiusSquared = f.radiusSquared[lane];
  const int left = f.left[lane], top = f.top[lane], columns = f.columns[lane], rows = f.rows[lane];
  const int middleX = f.middleX[lane], middleY = f.middleY[lane];
  const bool flat = f.flat[lane] != 0;
  const Tilt<float> tilt{f.tilt.alongU[lane], f.tilt.alongV[lane], f.tilt.bend[lane], f.tilt.least[lane], f.tilt.most[lane]};
  const Floats z = Floats{} + p.z[lane];
  for (int first = 0; first < columns; first += kLanes) {
    const Ints column = reinterpret_cast<Ints>(kIota) + first;
    const Ints x = column + left, inColumns = column < columns, isMiddleX = x == middleX;
    const Floats dx = __builtin_convertvector(x, Floats) - u;
    const Floats alongRow = tilt.alongU * dx;
    std::size_t at = static_cast<std::size_t>(top) * view.width + left + first;
    for (int y = top; y < top + rows; ++y, at += view.width) {
      const Floats dy = Floats{} + (static_cast<float>(y) - v);
      const Floats squaredDistance = dx * dx + dy * dy;
      Ints inside = inColumns & ~(squaredDistance > radiusSquared);
      Floats depth = z;
      if (!flat) inside &= depthAt(tilt, z, alongRow, Floats(tilt.alongV * dy), squaredDistance, Ints(y == middleY ? isMiddleX : Ints{}), depth);
      putRow<packed>(target, at, lanesOf(inside), reinterpret_cast<Words>(depth), payload);
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
  const Ints left = floorOf(p.u - half) + 1, top = floorOf(p.v - half) + 1;
  f.left = left < 0 ? Ints{} : left;
  f.top = top < 0 ? Ints{} : top;
  const Ints right = floorOf(p.u + half), bottom = floorOf(p.v + half);
  f.columns = (right < view.width ? right + 1 : Ints{} + view.width) - f.left;
  f.rows = (bottom < view.height ? bottom + 1 : Ints{} + view.height) - f.top;
  f.middleX = floorOf(p.u + 0.5f);
  f.middleY = floorOf(p.v + 0.5f);
  // A disc of two pixels and less is its square, else it could miss every centre.
  f.radiusSquared = size * size;
  if (view.round) f.radiusSquared = size > 2.0f ? half * half : f.radiusSquared;
  f.flat = ~Ints{};
  f.tilt = Tilt<Floats>{};
  if (view.cellNormals) layOnSurface<kind>(view, p, size, f);
  const Words payload = payloadOf(target, place, p.colour);
  const Ints wide = reaches & (size > kSideBySide);
  drawSideBySide<packed>(view, p, f, Ints(reaches & ~wide), payload, queue);
  for (Lanes waiting = lanesOf(wide); waiting != 0; waiting &= static_cast<Lanes>(waiting - 1)) {
    const int lane = __builtin_ctz(waiting);
    drawRows<packed>(view, p, f, lane, payload[lane], target);
  }
}

}  // namespace
}  // namespace alidade
