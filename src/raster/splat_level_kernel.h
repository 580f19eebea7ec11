// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points that are farther apart than a pixel, included by splat_kernel_body.h: each falls into a cell of the level that is as
// coarse as they are apart, where its surface has no holes but a few, and into one of the next finer level, as its detail.

namespace alidade {
namespace {

ALIDADE_LENS_INLINE Ints lookUp(const std::int32_t* table, const Ints& at) {
#if ALIDADE_SPLAT_LANES == 16
  return reinterpret_cast<Ints>(_mm512_permutexvar_epi32(reinterpret_cast<__m512i>(at), _mm512_castsi256_si512(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(table)))));
#elif ALIDADE_SPLAT_LANES == 8
  return reinterpret_cast<Ints>(_mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(table)), reinterpret_cast<__m256i>(at)));
#else
  Ints values;
  for (int i = 0; i < kLanes; ++i) values[i] = table[at[i]];
  return values;
#endif
}

/// The least level whose cells are as wide: ceil(log2(width)), 0 for a pixel and less.
ALIDADE_LENS_INLINE Ints levelOf(const Floats& width, int count) {
  const Ints level = ((reinterpret_cast<Ints>(width) - 1) >> 23) - 126;
  const Ints atLeast = level > 0 ? level : Ints{}, last = Ints{} + (count - 1);
  return atLeast < last ? atLeast : last;
}

/// Where a point falls: floor(256 u) and floor(256 v) from the picture's first corner on.
struct FinePlace {
  Ints u, v;
};

template <bool packed>
ALIDADE_LENS_INLINE void drawIntoLevel(const SplatLevels& levels, const Ints& level, const FinePlace& fine, Lanes drawn,
                                       const Words& depth, const Words& payload, bool hasPlaces, PixelQueue<packed>& queue) {
  const Ints isCoarse = level > 0;
  const Ints margin = isCoarse & SplatLevels::kMargin;
  const Ints u = fine.u >> level, v = fine.v >> level;  // in 256ths of a cell
  const Ints x = (u >> 8) + margin, y = (v >> 8) + margin;
  const Ints columns = lookUp(levels.columns, level), rows = lookUp(levels.rows, level);
  const Ints inside = (reinterpret_cast<Words>(x) < reinterpret_cast<Words>(columns)) & (reinterpret_cast<Words>(y) < reinterpret_cast<Words>(rows));
  const Ints at = y * columns + x + lookUp(levels.start, level);
  Words carried = payload;
  if (packed && hasPlaces) {
    const Ints inU = u & 255, inV = v & 255;
    const Ints placeV = inV < 254 ? inV : Ints{} + 254;  // never all ones: that is an empty payload
    carried |= reinterpret_cast<Words>(isCoarse & (inU | placeV << 8) << PlaceInCell::kColourBits);
  }
  queue.add(drawn & lanesOf(inside), at, depth, carried);
}

template <bool packed>
ALIDADE_LENS_INLINE void drawLevels(const SplatView& view, const Projected& p, PixelQueue<packed>& queue,
                                    const SplatTarget& target, std::uint32_t place) {
  const Lanes valid = lanesOf(p.valid);
  if (valid == 0) return;
  const FinePlace fine{floorOf(256.0f * (p.u + 0.5f)), floorOf(256.0f * (p.v + 0.5f))};
  const Floats wanted = view.sizeTimesDepth * p.inverse;
  const Ints level = levelOf(wanted < view.largest ? wanted : Floats{} + view.largest, view.levels->count);
  const Words depth = reinterpret_cast<Words>(p.z);
  const Words payload = payloadOf(target, place, p.colour);
  const bool hasPlaces = target.payload == SplatPayload::Colour;
  drawIntoLevel<packed>(*view.levels, level, fine, valid, depth, payload, hasPlaces, queue);
  const Lanes coarse = valid & lanesOf(level > 0);
  if (coarse != 0) drawIntoLevel<packed>(*view.levels, level > 0 ? level - 1 : Ints{}, fine, coarse, depth, payload, hasPlaces, queue);
}

}  // namespace
}  // namespace alidade
