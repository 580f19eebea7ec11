// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

namespace alidade {

/// The low 21 bits of v, two zero bits between each and the next (Morton 1966).
constexpr std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

/// The inverse of spreadBits: every third bit of v.
constexpr std::uint64_t gatherBits(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
  v = (v | v >> 4) & 0x100f00f00f00f00full;
  v = (v | v >> 8) & 0x1f0000ff0000ffull;
  v = (v | v >> 16) & 0x1f00000000ffffull;
  return (v | v >> 32) & 0x1fffff;
}

/// Morton code of three 21-bit numbers: x in the lowest bit.
constexpr std::uint64_t mortonOf(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spreadBits(x) | spreadBits(y) << 1 | spreadBits(z) << 2;
}

}  // namespace alidade
