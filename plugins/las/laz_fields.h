// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdlib>

#include "las/laz_coder.h"

// The fields of a record, and numbers that wrap.

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

template <class T>
T load(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

template <class T>
void store(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof(T));
}

/// Differences of integers that wrap as the format's do.
inline std::int32_t minus(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
inline std::int32_t plus(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}
inline std::int32_t times(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}
inline int clampToByte(int v) {
  return std::clamp(v, 0, 255);
}
inline std::uint8_t byteAt(const std::byte* at) {
  return std::to_integer<std::uint8_t>(*at);
}

/// The context that the k bits of other coordinates give.
inline unsigned evenUpTo(unsigned k, unsigned most) {
  return k < most ? k & ~1u : most;
}

/// A byte by a model chosen by its last value.
template <class Coder, int N>
[[gnu::always_inline]] inline void codeByte(Coder& coder, LazyModels<256, N>& models, std::uint8_t& last,
                                            std::uint8_t value) {
  last = static_cast<std::uint8_t>(coder.symbol(models[last], value));
}

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
