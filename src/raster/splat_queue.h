// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Points of one pixel, and the queue before the pixels for them, for dots in levels and for small footprints; included by
// splat_kernel_body.h.
//
// In a dense cloud most points lose against what is drawn already, and neighbours in a node fall on the same few pixels, so that
// load, compare and store a point make one long chain through memory. Here points first wait in a queue. When it is full, gathers tell
// which of them may win: one after another in a short loop, so that the processor waits for many lines of memory at once and not
// for each in turn between the arithmetic of its points. The winners are then drawn one by one. What a gather saw may be older than what
// is drawn before: that lets too many through, never too few.

namespace alidade {
namespace {

#if ALIDADE_SPLAT_LANES == 16

typedef __mmask16 Lanes;

ALIDADE_LENS_INLINE Ints floorOf(const Floats& v) {
  return reinterpret_cast<Ints>(_mm512_cvt_roundps_epi32(v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
}

/// Lanes of `valid` in [0, limit): a NaN or what no int holds became a negative number.
ALIDADE_LENS_INLINE Lanes within(const Ints& v, int limit, Lanes valid) {
  return _mm512_mask_cmplt_epu32_mask(valid, reinterpret_cast<__m512i>(v), _mm512_set1_epi32(limit));
}

ALIDADE_LENS_INLINE Lanes lanesOf(const Ints& mask) {
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask));
}

/// Lanes of `inside` whose depth is at most that of their pixel, `scale` bytes a pixel.
template <int scale>
ALIDADE_LENS_INLINE Lanes mayWin(const void* depths, const Ints& at, const Words& depth, Lanes inside) {
  const __m512i old = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), inside,
                                                  reinterpret_cast<__m512i>(at), depths, scale);
  return _mm512_mask_cmple_epu32_mask(inside, reinterpret_cast<__m512i>(depth), old);
}

/// The chosen lanes, side by side; writes a whole vector.
ALIDADE_LENS_INLINE void pack(std::uint32_t* to, Lanes chosen, const Words& words) {
  _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(chosen, reinterpret_cast<__m512i>(words)));
}

#elif ALIDADE_SPLAT_LANES == 8

typedef unsigned Lanes;

ALIDADE_LENS_INLINE Ints floorOf(const Floats& v) {
  return reinterpret_cast<Ints>(_mm256_cvttps_epi32(_mm256_floor_ps(v)));
}

ALIDADE_LENS_INLINE Lanes lanesOf(const Ints& mask) {
  return static_cast<Lanes>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
}

ALIDADE_LENS_INLINE Lanes within(const Ints& v, int limit, Lanes valid) {
  return valid & lanesOf(reinterpret_cast<Words>(v) < static_cast<std::uint32_t>(limit));
}

/// A byte a lane, all ones where the lane's bit is set.
ALIDADE_LENS_INLINE __m256i maskOf(Lanes lanes) {
  const __m256i bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(static_cast<int>(lanes)), bit), bit);
}

template <int scale>
ALIDADE_LENS_INLINE Lanes mayWin(const void* depths, const Ints& at, const Words& depth, Lanes inside) {
  const __m256i old = _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), static_cast<const int*>(depths),
                                                  reinterpret_cast<__m256i>(at), maskOf(inside), scale);
  return inside & lanesOf(depth <= reinterpret_cast<Words>(old));
}

/// For each choice of 8 lanes their numbers, side by side.
struct PackTable {
  alignas(64) std::uint8_t lane[256][8];
  constexpr PackTable() : lane() {
    for (int chosen = 0; chosen < 256; ++chosen)
      for (int bit = 0, at = 0; bit < 8; ++bit)
        if (chosen >> bit & 1) lane[chosen][at++] = static_cast<std::uint8_t>(bit);
  }
};
constexpr PackTable kPack;

ALIDADE_LENS_INLINE void pack(std::uint32_t* to, Lanes chosen, const Words& words) {
  const __m256i order =
      _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kPack.lane[chosen])));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(words), order));
}

#else

typedef unsigned Lanes;

/// A far negative number for NaN and what is beyond what an int holds.
ALIDADE_LENS_INLINE Ints floorOf(const Floats& v) {
  const Floats held = (v >= -1e9f) & (v < 1e9f) ? v : Floats{} - 1e9f;
  const Ints towardsZero = __builtin_convertvector(held, Ints);
  return towardsZero + (__builtin_convertvector(towardsZero, Floats) > held);  // true is -1
}

ALIDADE_LENS_INLINE Lanes lanesOf(const Ints& mask) {
#if defined(__SSE__)
  return static_cast<Lanes>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  Lanes lanes = 0;
  for (int i = 0; i < kLanes; ++i) lanes |= static_cast<Lanes>(mask[i] & 1 << i);
  return lanes;
#endif
}

ALIDADE_LENS_INLINE Lanes within(const Ints& v, int limit, Lanes valid) {
  return valid & lanesOf((v >= 0) & (v < limit));
}

/// Nothing to gather with: nearest wins where it is stored.
template <int scale>
ALIDADE_LENS_INLINE Lanes mayWin(const void*, const Ints&, const Words&, Lanes inside) {
  return inside;
}

#endif

/// Points on their way to their pixels.
template <bool packed>
class PixelQueue {
 public:
  explicit PixelQueue(const SplatTarget& target) : m_target(target) {}
  PixelQueue(const PixelQueue&) = delete;
  PixelQueue& operator=(const PixelQueue&) = delete;
  ALIDADE_LENS_INLINE ~PixelQueue() { drain(); }

  ALIDADE_LENS_INLINE void add(Lanes chosen, const Ints& at, const Words& depth, const Words& payload) {
#if ALIDADE_SPLAT_LANES == 4  // nothing to pack or to gather with
    for (int i = 0; i < kLanes; ++i)
      if (chosen >> i & 1) put<packed>(m_target, at[i], depth[i], payload[i]);
#else
    if (chosen == kAllLanes) {  // as nearly always
      store(m_at + m_count, reinterpret_cast<Words>(at));
      store(m_depth + m_count, depth);
      if constexpr (packed) store(m_payload + m_count, payload);
      m_count += kLanes;
    } else {
      pack(m_at + m_count, chosen, reinterpret_cast<Words>(at));
      pack(m_depth + m_count, chosen, depth);
      if constexpr (packed) pack(m_payload + m_count, chosen, payload);
      m_count += static_cast<unsigned>(__builtin_popcount(chosen));
    }
    if (m_count >= kHeld) drain();
#endif
  }

 private:
  static constexpr unsigned kHeld = 512;
  static constexpr auto kAllLanes = static_cast<Lanes>((1u << kLanes) - 1);

#if ALIDADE_SPLAT_LANES == 4
  void drain() {}
#else
  ALIDADE_LENS_INLINE static Words load(const std::uint32_t* from) {
    Words words;
    std::memcpy(&words, from, sizeof words);
    return words;
  }

  ALIDADE_LENS_INLINE static void store(std::uint32_t* to, const Words& words) { std::memcpy(to, &words, sizeof words); }

  ALIDADE_LENS_INLINE Lanes candidates(const Ints& at, const Words& depth, Lanes inside) const {
    if constexpr (packed) {  // the depth is the pixel's upper half
      return mayWin<8>(reinterpret_cast<const char*>(m_target.packed) + 4, at, depth, inside);
    } else {
      return mayWin<4>(m_target.depth, at, depth, inside);
    }
  }

  /// Those that may win move to the front, where others have been looked at already.
  void drain() {
    unsigned winners = 0;
    for (unsigned i = 0; i < m_count; i += kLanes) {
      const Words at = load(m_at + i), depth = load(m_depth + i);
      const Lanes inside = lanesOf(Ints(kIota < m_count - i));
      const Lanes chosen = candidates(reinterpret_cast<Ints>(at), depth, inside);
      const Words payload = packed ? load(m_payload + i) : at;
      pack(m_at + winners, chosen, at);
      pack(m_depth + winners, chosen, depth);
      if constexpr (packed) pack(m_payload + winners, chosen, payload);
      winners += static_cast<unsigned>(__builtin_popcount(chosen));
    }
    for (unsigned i = 0; i < winners; ++i) put<packed>(m_target, m_at[i], m_depth[i], packed ? m_payload[i] : 0);
    m_count = 0;
  }
#endif

  const SplatTarget& m_target;
  unsigned m_count = 0;
  alignas(64) std::uint32_t m_at[kHeld + kLanes], m_depth[kHeld + kLanes],
      m_payload[packed ? kHeld + kLanes : 1];
};

template <bool packed>
ALIDADE_LENS_INLINE void drawPixels(const SplatView& view, const Projected& p, PixelQueue<packed>& queue,
                                    const SplatTarget& target, std::uint32_t place) {
  const Floats u = p.u + 0.5f, v = p.v + 0.5f;
  const Ints column = floorOf(u), row = floorOf(v);
  const Lanes inside = within(row, view.height, within(column, view.width, lanesOf(p.valid)));
  const Ints at = row * view.width + column;
  const Words depth = reinterpret_cast<Words>(p.z);
  Words payload = {};
  if constexpr (packed) {
    payload = payloadOf(target, place, p.colour);
    if (target.payload == SplatPayload::Place) payload += placeInPixel(u, v, column, row);
  }
  queue.add(inside, at, depth, payload);
}

}  // namespace
}  // namespace alidade
