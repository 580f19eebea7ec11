// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace alidade {

/// Bits of one integer field: those of maximum - minimum, 0 for a constant (ASTM E2807-11, 9.7.4).
int packedBits(std::int64_t minimum, std::int64_t maximum);

/// Unpacks `count` integers of `bits` bits each, lowest bit first, from bit `firstBit` on, and adds
/// `minimum`. The 9 bytes after the last one used must be readable.
void unpackIntegers(const std::byte* stream, std::uint64_t firstBit, int bits, std::int64_t minimum, std::size_t count,
                    std::int64_t* out);

/// One field's bytes as they come in packets: one stream of bits over all packets.
class BitStream {
 public:
  void append(std::span<const std::byte> bytes);
  /// Bits that wait to be read.
  std::uint64_t available() const { return m_size * 8 - m_bit; }
  std::size_t bytesHeld() const { return m_size; }
  /// First unread bit of data(); the 16 bytes after the end are readable.
  std::uint64_t position() const { return m_bit; }
  const std::byte* data() const { return m_bytes.data(); }
  void skip(std::uint64_t bits) { m_bit += bits; }
  void clear() { m_size = m_bit = 0; }

 private:
  std::vector<std::byte> m_bytes;  ///< m_size used, 16 of slack
  std::size_t m_size = 0;
  std::uint64_t m_bit = 0;
};

}  // namespace alidade
