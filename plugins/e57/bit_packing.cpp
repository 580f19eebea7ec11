// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "e57/bit_packing.h"

#include <bit>
#include <cstring>

namespace alidade {

namespace {

constexpr std::size_t kSlack = 16;

std::uint64_t wordAt(const std::byte* bytes) {
  static_assert(std::endian::native == std::endian::little, "packed bits are read as little-endian words");
  std::uint64_t word;
  std::memcpy(&word, bytes, 8);
  return word;
}

template <class T>
void unpackWhole(const std::byte* from, std::uint64_t minimum, std::size_t count, std::int64_t* out) {
  for (std::size_t i = 0; i < count; ++i) {
    T value;
    std::memcpy(&value, from + i * sizeof(T), sizeof(T));
    out[i] = static_cast<std::int64_t>(minimum + value);
  }
}

}  // namespace

int packedBits(std::int64_t minimum, std::int64_t maximum) {
  return std::bit_width(static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum));
}

void unpackIntegers(const std::byte* stream, std::uint64_t firstBit, int bits, std::int64_t minimum, std::size_t count,
                    std::int64_t* out) {
  const auto base = static_cast<std::uint64_t>(minimum);  // sums wrap as the writer's differences did
  if (bits == 0) {
    for (std::size_t i = 0; i < count; ++i) out[i] = minimum;
    return;
  }
  if (firstBit % 8 == 0) {
    const std::byte* from = stream + firstBit / 8;
    if (bits == 8) return unpackWhole<std::uint8_t>(from, base, count, out);
    if (bits == 16) return unpackWhole<std::uint16_t>(from, base, count, out);
    if (bits == 32) return unpackWhole<std::uint32_t>(from, base, count, out);
    if (bits == 64) return unpackWhole<std::uint64_t>(from, base, count, out);
  }
  const std::uint64_t mask = bits == 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1;
  std::uint64_t bit = firstBit;
  for (std::size_t i = 0; i < count; ++i, bit += static_cast<std::uint64_t>(bits)) {
    const std::byte* from = stream + bit / 8;
    const int shift = static_cast<int>(bit % 8);
    std::uint64_t value = wordAt(from) >> shift;
    // Only wide values can reach into a ninth byte.
    if (shift + bits > 64) value |= static_cast<std::uint64_t>(from[8]) << (64 - shift);
    out[i] = static_cast<std::int64_t>(base + (value & mask));
  }
}

void BitStream::append(std::span<const std::byte> bytes) {
  const std::size_t used = m_bit / 8;
  if (used > 0) {
    std::memmove(m_bytes.data(), m_bytes.data() + used, m_size - used);
    m_size -= used;
    m_bit -= used * 8;
  }
  if (m_bytes.size() < m_size + bytes.size() + kSlack) m_bytes.resize(m_size + bytes.size() + kSlack);
  if (!bytes.empty()) std::memcpy(m_bytes.data() + m_size, bytes.data(), bytes.size());
  m_size += bytes.size();
}

}  // namespace alidade
