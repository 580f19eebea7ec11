// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Vectors for kernels that are compiled once for each instruction set; only their sources include this, with
// ALIDADE_LANES defined. Everything here has internal linkage, so that no copy made for one processor is left
// for the linker to hand to another.

#pragma once

#include <cstdint>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "camera/lens_kernel.h"

namespace alidade {
namespace {

constexpr int kLanes = ALIDADE_LANES;
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * kLanes)));
typedef std::uint8_t Bytes __attribute__((vector_size(4 * kLanes)));

#if ALIDADE_LANES == 16
constexpr Ints kIota = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#elif ALIDADE_LANES == 8
constexpr Ints kIota = {0, 1, 2, 3, 4, 5, 6, 7};
#else
constexpr Ints kIota = {0, 1, 2, 3};
#endif

ALIDADE_LENS_INLINE Floats all(float value) {
  return Floats{} + value;
}
ALIDADE_LENS_INLINE Ints all(std::int32_t value) {
  return Ints{} + value;
}
ALIDADE_LENS_INLINE Words all(std::uint32_t value) {
  return Words{} + value;
}

template <class Vector, class Element>
ALIDADE_LENS_INLINE Vector load(const Element* from) {
  static_assert(sizeof(Element) == 4);
  Vector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class Vector, class Element>
ALIDADE_LENS_INLINE void store(Element* to, const Vector& v) {
  static_assert(sizeof(Element) == 4);
  std::memcpy(to, &v, sizeof v);
}
/// The first `count` lanes; the others are zero and untouched.
template <class Vector, class Element>
ALIDADE_LENS_INLINE Vector loadSome(const Element* from, int count) {
  if (count >= kLanes) return load<Vector>(from);
#if defined(__AVX512DQ__) && ALIDADE_LANES == 16
  return reinterpret_cast<Vector>(_mm512_maskz_loadu_epi32(static_cast<__mmask16>((1u << count) - 1), from));
#elif defined(__AVX2__) && ALIDADE_LANES == 8
  const __m256i mask = reinterpret_cast<__m256i>(kIota < count);
  return reinterpret_cast<Vector>(_mm256_maskload_epi32(reinterpret_cast<const int*>(from), mask));
#else
  Vector v{};
  std::memcpy(&v, from, 4 * static_cast<std::size_t>(count));
  return v;
#endif
}
template <class Vector, class Element>
ALIDADE_LENS_INLINE void storeSome(Element* to, const Vector& v, int count) {
  if (count >= kLanes) return store(to, v);
#if defined(__AVX512DQ__) && ALIDADE_LANES == 16
  _mm512_mask_storeu_epi32(to, static_cast<__mmask16>((1u << count) - 1), reinterpret_cast<__m512i>(v));
#elif defined(__AVX2__) && ALIDADE_LANES == 8
  const __m256i mask = reinterpret_cast<__m256i>(kIota < count);
  _mm256_maskstore_epi32(reinterpret_cast<int*>(to), mask, reinterpret_cast<__m256i>(v));
#else
  std::memcpy(to, &v, 4 * static_cast<std::size_t>(count));
#endif
}
#if defined(__AVX512BW__) && ALIDADE_LANES == 16
/// Bit i of a lane i below `count`.
ALIDADE_LENS_INLINE __mmask16 firstLanes(int count) {
  return static_cast<__mmask16>(count >= kLanes ? 0xffff : (1u << count) - 1);
}
#endif
/// Bytes to words, and back. Written out, because compilers take a vector of bytes apart one by one.
ALIDADE_LENS_INLINE Ints loadBytes(const std::uint8_t* from, int count) {
#if defined(__AVX512BW__) && ALIDADE_LANES == 16
  return reinterpret_cast<Ints>(_mm512_cvtepu8_epi32(_mm_maskz_loadu_epi8(firstLanes(count), from)));
#else
  typedef std::uint8_t Few __attribute__((vector_size(kLanes)));
  Few few{};
  if (count >= kLanes)
    std::memcpy(&few, from, kLanes);
  else
    std::memcpy(&few, from, static_cast<std::size_t>(count));
#if defined(__AVX2__) && ALIDADE_LANES == 8
  return reinterpret_cast<Ints>(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&few))));
#else
  return __builtin_convertvector(few, Ints);
#endif
#endif
}
ALIDADE_LENS_INLINE void storeBytes(std::uint8_t* to, const Ints& v, int count) {
#if defined(__AVX512BW__) && ALIDADE_LANES == 16
  _mm_mask_storeu_epi8(to, firstLanes(count), _mm512_cvtepi32_epi8(reinterpret_cast<__m512i>(v)));
#else
  typedef std::uint8_t Few __attribute__((vector_size(kLanes)));
  const Few few = __builtin_convertvector(v, Few);
  if (count >= kLanes)
    std::memcpy(to, &few, kLanes);
  else
    std::memcpy(to, &few, static_cast<std::size_t>(count));
#endif
}

ALIDADE_LENS_INLINE Ints asInts(const Floats& v) {
  return reinterpret_cast<Ints>(v);
}
ALIDADE_LENS_INLINE Ints asInts(const Words& v) {
  return reinterpret_cast<Ints>(v);
}
ALIDADE_LENS_INLINE Words asWords(const Ints& v) {
  return reinterpret_cast<Words>(v);
}
ALIDADE_LENS_INLINE Floats toFloats(const Ints& v) {
  return __builtin_convertvector(v, Floats);
}
ALIDADE_LENS_INLINE Ints truncated(const Floats& v) {
  return __builtin_convertvector(v, Ints);
}
/// Of what fits an int.
ALIDADE_LENS_INLINE Ints roundedDown(const Floats& v) {
  const Ints whole = truncated(v);
  return whole + (toFloats(whole) > v);  // true is -1
}

template <class Vector>
ALIDADE_LENS_INLINE Vector smaller(const Vector& a, const Vector& b) {
  return a < b ? a : b;
}
template <class Vector>
ALIDADE_LENS_INLINE Vector larger(const Vector& a, const Vector& b) {
  return a > b ? a : b;
}
ALIDADE_LENS_INLINE Floats absolute(const Floats& v) {
  return reinterpret_cast<Floats>(asInts(v) & 0x7fffffff);
}
ALIDADE_LENS_INLINE Floats mix(const Floats& a, const Floats& b, const Floats& share) {
  return a + (b - a) * share;
}

/// Bit i where lane i of a comparison holds.
ALIDADE_LENS_INLINE unsigned bitsOf(const Ints& mask) {
#if defined(__AVX512DQ__) && ALIDADE_LANES == 16
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX2__) && ALIDADE_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#elif defined(__SSE2__) && ALIDADE_LANES == 4
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  unsigned bits = 0;
  for (int i = 0; i < kLanes; ++i) bits |= (mask[i] ? 1u : 0u) << i;
  return bits;
#endif
}
ALIDADE_LENS_INLINE bool any(const Ints& mask) {
  return bitsOf(mask) != 0;
}

/// The 32 bits at base + scale × index (bytes) where `mask` holds, else zero.
template <int scale = 4>
ALIDADE_LENS_INLINE Ints gathered(const void* base, const Ints& index, const Ints& mask) {
#if defined(__AVX512DQ__) && ALIDADE_LANES == 16
  return reinterpret_cast<Ints>(_mm512_mask_i32gather_epi32(_mm512_setzero_si512(),
                                                            static_cast<__mmask16>(bitsOf(mask)),
                                                            reinterpret_cast<__m512i>(index), base, scale));
#elif defined(__AVX2__) && ALIDADE_LANES == 8
  return reinterpret_cast<Ints>(
      _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), static_cast<const int*>(base),
                                  reinterpret_cast<__m256i>(index), reinterpret_cast<__m256i>(mask), scale));
#else
  Ints out{};
  for (int i = 0; i < kLanes; ++i)
    if (mask[i]) {
      std::int32_t value;
      std::memcpy(&value, static_cast<const char*>(base) + static_cast<std::ptrdiff_t>(scale) * index[i], 4);
      out[i] = value;
    }
  return out;
#endif
}
template <int scale = 4>
ALIDADE_LENS_INLINE Floats gatheredFloats(const void* base, const Ints& index, const Ints& mask) {
  return reinterpret_cast<Floats>(gathered<scale>(base, index, mask));
}

/// Appends the lanes where `mask` holds, in order; returns their number. There must be room for all.
ALIDADE_LENS_INLINE int append(std::int32_t* to, const Ints& v, const Ints& mask) {
  const unsigned bits = bitsOf(mask);
#if defined(__AVX512DQ__) && ALIDADE_LANES == 16
  _mm512_storeu_si512(
      to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), reinterpret_cast<__m512i>(v)));
#else
  int count = 0;
  for (unsigned left = bits; left; left &= left - 1) to[count++] = v[__builtin_ctz(left)];
#endif
  return __builtin_popcount(bits);
}

}  // namespace
}  // namespace alidade
