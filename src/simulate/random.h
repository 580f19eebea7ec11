// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace alidade {

/// The finaliser of splitmix64 (Steele, Lea, Flood 2014): a bijection that spreads every bit.
constexpr std::uint64_t mixBits(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

/// A random sequence that belongs to one (seed, stream, index), such as one ray of one station. It has no
/// state that threads share, so the same options give the same bytes however many threads run.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t stream, std::uint64_t index = 0)
      : m_state(mixBits(mixBits(mixBits(seed) ^ stream) ^ index)) {}

  std::uint64_t next() { return mixBits(m_state++); }
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  int integer(int count) { return static_cast<int>(uniform() * count); }
  /// Mean 0, standard deviation 1 (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  /// Nearly normal, within ±3.5 (the sum of four uniforms): for millions of pixels.
  float quickNormal() {
    const std::uint64_t bits = next();
    const auto sum =
        static_cast<float>((bits & 0xFFFF) + (bits >> 16 & 0xFFFF) + (bits >> 32 & 0xFFFF) + (bits >> 48));
    return (sum * 0x1.0p-16f - 2.0f) * 1.7320508f;
  }

 private:
  std::uint64_t m_state;
};

}  // namespace alidade
