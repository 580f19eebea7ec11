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

template <bool packed>
ALIDADE_LENS_INLINE void drawIntoLevel(const SplatLevels& levels, const Ints& level, const Ints& column, const Ints& row, Lanes drawn,
                                       const Words& depth, const Words& payload, const Floats& u, const Floats& v, bool hasPlaces, PixelQueue<packed>& queue) {
  const Ints margin = level > 0 ? Ints{} + SplatLevels::kMargin : Ints{};
  const Ints x = (column >> level) + margin, y = (row >> level) + margin;
  const Ints columns = lookUp(levels.columns, level), rows = lookUp(levels.rows, level);
  const Ints inside = (reinterpret_cast<Words>(x) < reinterpret_cast<Words>(columns)) & (reinterpret_cast<Words>(y) < reinterpret_cast<Words>(rows));
  const Ints at = y * columns + x + lookUp(levels.start, level);
  Words carried = payload;
  const Ints isCoarse = level > 0;
  if (packed && hasPlaces && lanesOf(isCoarse) != 0) {
    // 256 / 2^level, by its exponent.
    const Floats steps = reinterpret_cast<Floats>((127 + 8 - level) << 23);
    const Ints inU = __builtin_convertvector((u - __builtin_convertvector(column - (column & ((1 << level) - 1)), Floats)) * steps, Ints);
    const Ints inV = __builtin_convertvector((v - __builtin_convertvector(row - (row & ((1 << level) - 1)), Floats)) * steps, Ints);
    // A coordinate may round to the cell's far border. Never all ones: that is an empty payload.
    const Ints placeU = inU < 255 ? inU : Ints{} + 255, placeV = inV < 254 ? inV : Ints{} + 254;
    carried |= reinterpret_cast<Words>(isCoarse & ((placeU & 255) | (placeV & 255) << 8) << PlaceInCell::kColourBits);
  }
  queue.add(drawn & lanesOf(inside), at, depth, carried);
}

template <bool packed>
ALIDADE_LENS_INLINE void drawLevels(const SplatView& view, const Projected& p, PixelQueue<packed>& queue,
                                    const SplatTarget& target, std::uint32_t place) {
  const Floats u = p.u + 0.5f, v = p.v + 0.5f;
  const Ints column = floorOf(u), row = floorOf(v);
  const Lanes valid = lanesOf(p.valid);
  if (valid == 0) return;
  const Floats wanted = view.sizeTimesDepth * p.inverse;
  const Ints level = levelOf(wanted < view.largest ? wanted : Floats{} + view.largest, view.levels->count);
  const Words depth = reinterpret_cast<Words>(p.z);
  const Words payload = payloadOf(target, place, p.colour);
  const bool hasPlaces = target.payload == SplatPayload::Colour;
  drawIntoLevel<packed>(*view.levels, level, column, row, valid, depth, payload, u, v, hasPlaces, queue);
  const Lanes coarse = valid & lanesOf(level > 0);
  if (coarse != 0) drawIntoLevel<packed>(*view.levels, level > 0 ? level - 1 : Ints{}, column, row, coarse, depth, payload, u, v, hasPlaces, queue);
}

}  // namespace
}  // namespace alidade
