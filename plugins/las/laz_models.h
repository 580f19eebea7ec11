// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

// Everything here may be compiled for several instruction sets (laz_chunk_body.h), each in a namespace of its own.
#if !defined(ALIDADE_LAZ_SET)
#define ALIDADE_LAZ_SET baseline
#endif

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

/// How many of 16 rising numbers are at most `limit`, which is below 2^16 - 1.
[[gnu::always_inline]] inline std::size_t countUpTo16(const std::uint16_t* numbers, std::uint32_t limit) {
#if defined(ALIDADE_LAZ_AVX512)
  const __m256i wanted = _mm256_set1_epi16(static_cast<short>(limit));
  const __m256i sixteen = _mm256_load_si256(reinterpret_cast<const __m256i*>(numbers));
  return static_cast<std::size_t>(__builtin_popcount(_mm256_cmple_epu16_mask(sixteen, wanted)));
#elif defined(ALIDADE_LAZ_AVX2)
  const __m256i wanted = _mm256_set1_epi16(static_cast<short>(limit));
  const __m256i sixteen = _mm256_load_si256(reinterpret_cast<const __m256i*>(numbers));
  const __m256i atMost = _mm256_cmpeq_epi16(_mm256_max_epu16(sixteen, wanted), wanted);
  return static_cast<std::size_t>(__builtin_popcount(static_cast<unsigned>(_mm256_movemask_epi8(atMost)))) / 2;
#elif defined(__SSE2__)
  // Saturated to 0 means at most `limit`.
  const __m128i wanted = _mm_set1_epi16(static_cast<short>(limit)), zero = _mm_setzero_si128();
  const auto atMost = [&](const std::uint16_t* eight) {
    return _mm_cmpeq_epi16(_mm_subs_epu16(_mm_load_si128(reinterpret_cast<const __m128i*>(eight)), wanted), zero);
  };
  const int mask = _mm_movemask_epi8(_mm_packs_epi16(atMost(numbers), atMost(numbers + 8)));
  return static_cast<std::size_t>(__builtin_ctz(~static_cast<unsigned>(mask)));
#else
  std::size_t count = 0;
  for (int i = 0; i < 16; ++i) count += numbers[i] <= limit;
  return count;
#endif
}

/// The same of Count numbers, a multiple of 16.
template <int Count>
[[gnu::always_inline]] inline std::size_t countUpTo(const std::uint16_t* numbers, std::uint32_t limit) {
  std::size_t count = 0;
  int i = 0;
#if defined(ALIDADE_LAZ_AVX512)
  for (; i + 32 <= Count; i += 32) {
    const __m512i wanted = _mm512_set1_epi16(static_cast<short>(limit));
    const __m512i some = _mm512_load_si512(numbers + i);
    count += static_cast<std::size_t>(__builtin_popcount(_mm512_cmple_epu16_mask(some, wanted)));
  }
#endif
  for (; i < Count; i += 16) count += countUpTo16(numbers + i, limit);
  return count;
}

/// Up to how many numbers are sooner compared all than sought in two steps.
#if defined(ALIDADE_LAZ_AVX512)
constexpr int kComparedAll = 128;
#else
constexpr int kComparedAll = 48;
#endif

/// Stands behind the last cumulated frequency: above every place that a decoder may look for (see find).
constexpr std::uint32_t kBeyond = (1 << 15) + (1 << 6);

/// An adaptive model of `symbols` symbols, at most Capacity: cumulated frequencies in 2^-15, renewed from
/// counts at growing distances (A. Said, "Introduction to Arithmetic Coding", HPL-2004-76, and the
/// LASzip specification). Symbols are found by comparing whole vectors: no loop that a processor would have to guess the
/// length of. In large models the group of 16 is found first.
template <int Capacity>
class SymbolModel {
 public:
  static constexpr int kGroups = (Capacity + 15) / 16;
  static constexpr std::uint32_t kMaxTotal = 1 << 15;

  explicit SymbolModel(int symbols = Capacity) : m_symbols(static_cast<std::uint16_t>(symbols)) {
    m_low.fill(kBeyond);
    m_first.fill(0xFFFF);
    m_counts.fill(0);
    for (int i = 0; i < symbols; ++i) m_counts[i] = 1;
    m_cycle = static_cast<std::uint32_t>(symbols);
    renew();
    m_cycle = m_untilRenewal = (static_cast<std::uint32_t>(symbols) + 6) >> 1;
  }

  /// A symbol and the cumulated frequencies below it and below the next, which is kBeyond for the last.
  struct Found {
    unsigned symbol;
    std::uint32_t low, next;
  };

  /// Cumulated frequency below the symbol.
  std::uint32_t low(unsigned symbol) const { return m_low.data()[symbol]; }
  unsigned last() const { return m_symbols - 1u; }

  /// The symbol whose share of [0, 2^15) holds `place`; the last where it lies beyond, by less than 2^6: a value below
  /// the length, in steps of length / 2^15, which are at least 2^9, of whose 2^15 the length's rest is below 2^6.
  [[gnu::always_inline]] Found find(std::uint32_t place) const {
    // The frequencies are read beside the group's beginning: the symbol itself is wanted later than they are.
    const std::uint16_t* group = m_low.data();
    std::size_t count;
    if constexpr (kGrouped) {
      group += 16 * (countUpTo<kFirst>(m_first.data(), place) - 1);
      count = countUpTo16(group, place);
    } else {
      count = countUpTo<16 * kGroups>(group, place);
    }
    return {static_cast<unsigned>(group - m_low.data() + count) - 1, group[count - 1], group[count]};
  }

  void learn(unsigned symbol) {
    ++m_counts[symbol];
    if (--m_untilRenewal == 0) renew();
  }

 private:
  static constexpr bool kGrouped = Capacity > kComparedAll;
  static constexpr int kFirst = kGrouped ? (kGroups + 15) / 16 * 16 : 0;

  [[gnu::noinline]] void renew() {
    m_total += m_cycle;
    if (m_total > kMaxTotal) {
      m_total = 0;
      for (int i = 0; i < m_symbols; ++i) m_total += m_counts[i] = static_cast<std::uint16_t>((m_counts[i] + 1) >> 1);
    }
    const std::uint32_t scale = 0x80000000u / m_total;
    std::uint32_t sum = 0;
    for (int i = 0; i < m_symbols; ++i) {
      m_low[i] = static_cast<std::uint16_t>((scale * sum) >> 16);
      sum += m_counts[i];
    }
    if constexpr (kGrouped)
      for (int group = 0; 16 * group < m_symbols; ++group) m_first[group] = m_low[16 * group];
    m_cycle = std::min((5 * m_cycle) >> 2, (m_symbols + 6u) << 3);
    m_untilRenewal = m_cycle;
  }

  alignas(64) std::array<std::uint16_t, 16 * kGroups + 16> m_low;
  alignas(kGrouped ? 64 : 1) std::array<std::uint16_t, kFirst> m_first;  ///< every 16th of m_low; only where grouped
  std::array<std::uint16_t, 16 * kGroups> m_counts;
  std::uint32_t m_total = 0, m_cycle = 0, m_untilRenewal = 0;
  std::uint16_t m_symbols;
};

/// The same for a single bit, in 2^-13.
class BitModel {
 public:
  std::uint32_t zeroShare() const { return m_zeroShare; }

  void learn(unsigned bit) {
    m_zeros += bit == 0;
    if (--m_untilRenewal == 0) renew();
  }

 private:
  [[gnu::noinline]] void renew() {
    m_total += m_cycle;
    if (m_total > 1 << 13) {
      m_total = (m_total + 1) >> 1;
      m_zeros = (m_zeros + 1) >> 1;
      if (m_zeros == m_total) ++m_total;
    }
    m_zeroShare = (m_zeros * (0x80000000u / m_total)) >> 18;
    m_cycle = std::min((5 * m_cycle) >> 2, 64u);
    m_untilRenewal = m_cycle;
  }

  std::uint32_t m_zeros = 1, m_total = 2, m_zeroShare = 1 << 12, m_cycle = 4, m_untilRenewal = 4;
};

/// How a corrected prediction is coded: the number k of bits that the correction takes (a model for
/// each of Contexts), then the correction itself, its upper 8 bits by a model and the others as they are.
/// Bits is the width of the numbers: 8, 16 or 32.
template <int Bits, int Contexts>
class IntegerModel {
 public:
  static constexpr int kModelled = 8;

  IntegerModel() {
    m_width.fill(SymbolModel<Bits + 1>());
    for (int k = 1; k <= 4; ++k) m_small[k - 1] = SymbolModel<16>(1 << k);
    for (int k = 5; k <= Bits; ++k) m_large[k - 5] = SymbolModel<256>(1 << std::min(k, kModelled));
  }

  SymbolModel<Bits + 1>& width(unsigned context) { return m_width[context]; }
  BitModel& bit() { return m_bit; }
  SymbolModel<16>& small(unsigned k) { return m_small[k - 1]; }    ///< k in 1..4
  SymbolModel<256>& large(unsigned k) { return m_large[k - 5]; }   ///< k in 5..Bits

  unsigned k = 0;  ///< of the number coded last: the context of others

  // Of the number that is being coded.
  std::int32_t predicted = 0;
  std::uint32_t code = 0;

 private:
  std::array<SymbolModel<Bits + 1>, Contexts> m_width;
  std::array<SymbolModel<16>, 4> m_small;
  std::array<SymbolModel<256>, Bits - 4> m_large;
  BitModel m_bit;
};

/// As new. A copy of an untouched one costs less than working it out again.
template <class Model>
void renew(Model& model) {
  static const Model fresh;
  model = fresh;
}

/// Models of which few are ever used: made when first asked for, kept for the next chunk.
template <int Symbols, int Count>
class LazyModels {
 public:
  SymbolModel<Symbols>& operator[](unsigned i) {
    if (!m_used[i]) make(i);
    return *m_models[i];
  }
  void reset() { m_used.fill(false); }

 private:
  [[gnu::noinline]] void make(unsigned i) {
    if (!m_models[i]) m_models[i] = std::make_unique<SymbolModel<Symbols>>();
    renew(*m_models[i]);
    m_used[i] = true;
  }

  std::array<std::unique_ptr<SymbolModel<Symbols>>, Count> m_models;
  std::array<bool, Count> m_used{};
};

/// The middle of five numbers that follow a sequence: each new one pushes out the largest or the
/// smallest, by turns. Without branches: where a number falls is as good as random.
class StreamingMedian {
 public:
  std::int32_t get() const { return m_sorted[2]; }

  void add(std::int32_t v) {
    using Four [[gnu::vector_size(16)]] = std::int32_t;
    const std::int32_t middle = m_sorted[2];
    Four kept;
    std::memcpy(&kept, m_sorted.data() + (m_dropLargest ? 0 : 1), sizeof kept);
    m_dropLargest = (v < middle) | (!m_dropLargest & (v == middle));
    // The number goes in where it stands between its neighbours.
    const Four below = __builtin_shufflevector(kept, Four{INT32_MIN}, 4, 0, 1, 2);
    const Four capped = kept < v ? kept : v - Four{};
    const Four sorted = below > capped ? below : capped;
    std::memcpy(m_sorted.data(), &sorted, sizeof sorted);
    m_sorted[4] = std::max(kept[3], v);
  }

 private:
  std::array<std::int32_t, 5> m_sorted{};
  bool m_dropLargest = true;
};

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
