// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "las/laz_models.h"

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

/// Bytes that must be readable behind a compressed stream: what one point takes at most (two bytes a symbol), or
/// 64 points of a layer, before `hold` is called.
constexpr std::size_t kPadding = 1 << 14;

constexpr std::uint32_t kMinLength = 1u << 24;

/// Range decoder of the LASzip specification. Decoder and encoder have the same methods, so that one text of an item
/// serves both: each takes the value to encode and returns the value coded, which the decoder makes up alone.
///
/// Never fails: past the end it reads what stands there, and `overran` tells.
class Decoder {
 public:
  static constexpr bool kEncodes = false;

  Decoder() = default;
  /// kPadding bytes behind `bytes` must be readable.
  explicit Decoder(std::span<const std::byte> bytes)
      : m_at(bytes.data()), m_end(bytes.data() + bytes.size()), m_limit(m_end + 4) {
    // The format's values are below the length; no damaged one shall be otherwise.
    m_value = std::min(next(), m_length - 1);
    m_at = bytes.size() < 4 ? m_limit : m_at + 4;
  }

  bool overran() const { return m_at > m_end; }
  /// To be called after each point: goes back to the end where it was passed.
  void hold() { m_at = std::min(m_at, m_limit); }
  /// Behind the last byte taken.
  const std::byte* position() const { return m_at; }

  template <int Capacity>
  [[gnu::always_inline]] unsigned symbol(SymbolModel<Capacity>& model, unsigned = 0) {
    const std::uint32_t step = m_length >> 15;
    const unsigned symbol = model.find(m_value / step);
    const std::uint32_t low = model.low(symbol) * step;
    // Both are worked out, so that no branch is guessed; what stands behind the last symbol is not used.
    std::uint32_t high = model.low(symbol + 1) * step;
    high = symbol == model.last() ? m_length : high;
    m_value -= low;
    m_length = high - low;
    normalise();
    model.learn(symbol);
    return symbol;
  }

  [[gnu::always_inline]] unsigned bit(BitModel& model, unsigned = 0) {
    const std::uint32_t zeros = model.zeroShare() * (m_length >> 13);
    const unsigned bit = m_value >= zeros;
    m_value -= bit ? zeros : 0;
    m_length = bit ? m_length - zeros : zeros;
    normalise();
    model.learn(bit);
    return bit;
  }

  [[gnu::always_inline]] std::uint32_t bits(unsigned count, std::uint32_t = 0) {
    if (count > 19) {
      const std::uint32_t lower = fewBits(16);
      return fewBits(count - 16) << 16 | lower;
    }
    return fewBits(count);
  }

 private:
  [[gnu::always_inline]] std::uint32_t fewBits(unsigned count) {
    m_length >>= count;
    const std::uint32_t number = m_value / m_length;
    m_value -= m_length * number;
    normalise();
    return number & ((1u << count) - 1);
  }

  std::uint32_t next() const {
    std::uint32_t bytes;
    std::memcpy(&bytes, m_at, 4);
    return __builtin_bswap32(bytes);
  }

  /// Takes in as many bytes as the length has lost. Without a branch: whether one is due is as good as random.
  [[gnu::always_inline]] void normalise() {
    const unsigned shift = static_cast<unsigned>(__builtin_clz(m_length)) & 24u;
    m_value = m_value << shift | (next() >> 1) >> (31 - shift);
    m_length <<= shift;
    m_at += shift >> 3;
  }

  std::uint32_t m_value = 0, m_length = 0xFFFFFFFFu;
  const std::byte* m_at = nullptr;
  const std::byte* m_end = nullptr;
  const std::byte* m_limit = nullptr;
};

/// Range encoder; see Decoder.
class Encoder {
 public:
  static constexpr bool kEncodes = true;

  template <int Capacity>
  unsigned symbol(SymbolModel<Capacity>& model, unsigned symbol) {
    const std::uint32_t step = m_length >> 15;
    const std::uint32_t low = model.low(symbol) * step;
    const std::uint32_t high = symbol == model.last() ? m_length : model.low(symbol + 1) * step;
    narrow(low, high - low);
    model.learn(symbol);
    return symbol;
  }

  unsigned bit(BitModel& model, unsigned bit) {
    const std::uint32_t zeros = model.zeroShare() * (m_length >> 13);
    if (bit)
      narrow(zeros, m_length - zeros);
    else
      narrow(0, zeros);
    model.learn(bit);
    return bit;
  }

  std::uint32_t bits(unsigned count, std::uint32_t number) {
    if (count > 19) {
      fewBits(16, number & 0xFFFF);
      fewBits(count - 16, number >> 16);
    } else {
      fewBits(count, number);
    }
    return number;
  }

  /// Ends the stream so that the decoder, which reads four bytes ahead, stops at its end. The bytes
  /// are handed over and the encoder is as new.
  std::vector<std::byte> finish() {
    const bool oneMore = m_length > 2 * kMinLength;
    const std::uint32_t low = oneMore ? kMinLength : kMinLength >> 1;
    m_length = 0xFFFFFFFFu;  // narrow() subtracts nothing from it
    narrow(low, oneMore ? kMinLength >> 1 : kMinLength >> 9);
    m_bytes.resize(m_bytes.size() + (oneMore ? 3 : 2));
    std::vector<std::byte> bytes = std::move(m_bytes);
    *this = Encoder();
    return bytes;
  }

 private:
  void fewBits(unsigned count, std::uint32_t number) {
    const std::uint32_t step = m_length >> count;
    narrow(number * step, step);
  }

  void narrow(std::uint32_t low, std::uint32_t length) {
    const std::uint32_t before = m_base;
    m_base += low;
    m_length = length;
    if (m_base < before) carry();
    while (m_length < kMinLength) {
      m_bytes.push_back(static_cast<std::byte>(m_base >> 24));
      m_base <<= 8;
      m_length <<= 8;
    }
  }

  void carry() {
    for (std::size_t i = m_bytes.size(); i-- > 0;) {
      m_bytes[i] = static_cast<std::byte>(std::to_integer<unsigned>(m_bytes[i]) + 1);
      if (m_bytes[i] != std::byte{0}) break;
    }
  }

  std::uint32_t m_base = 0, m_length = 0xFFFFFFFFu;
  std::vector<std::byte> m_bytes;
};

/// Runs `body` with a decoder that lives in registers: a copy that no store to a record can alias.
template <class Coder, class Body>
[[gnu::always_inline]] inline auto inRegisters(Coder& coder, const Body& body) {
  if constexpr (Coder::kEncodes) {
    return body(coder);
  } else {
    Coder local = coder;
    body(local);
    coder = local;
  }
}

/// Codes `value`, a number of Bits bits, as its difference from `predicted`; leaves the number of the
/// difference's bits in `model.k`.
template <class Coder, int Bits, int Contexts>
[[gnu::always_inline]] inline std::int32_t codeInteger(Coder& coder, IntegerModel<Bits, Contexts>& model,
                                                       std::int32_t predicted, unsigned context,
                                                       std::int32_t value = 0) {
  constexpr std::int64_t kRange = std::int64_t{1} << Bits;
  std::uint32_t code = 0;
  unsigned k = 0;
  if constexpr (Coder::kEncodes) {
    std::int64_t difference = Bits == 32 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(value) -
                                                                     static_cast<std::uint32_t>(predicted))
                                         : std::int64_t{value} - predicted;
    if (Bits < 32 && difference < -kRange / 2) difference += kRange;
    if (Bits < 32 && difference > kRange / 2 - 1) difference -= kRange;
    // k bits hold the differences from -(2^k - 1) to -2^(k-1) and from 2^(k-1) + 1 to 2^k; no bits 0 and 1.
    k = static_cast<unsigned>(std::bit_width(static_cast<std::uint32_t>(difference <= 0 ? -difference : difference - 1)));
    code = static_cast<std::uint32_t>(k == 0 ? difference : difference < 0 ? difference + (std::int64_t{1} << k) - 1 : difference - 1);
  }
  model.k = k = coder.symbol(model.width(context), k);
  std::int32_t difference;
  if (k == 0) {
    difference = static_cast<std::int32_t>(coder.bit(model.bit(), code));
  } else if (k == 32) {
    difference = INT32_MIN;
  } else {
    if (k <= 4) {
      code = coder.symbol(model.small(k), code);
    } else if (k <= 8) {
      code = coder.symbol(model.large(k), code);
    } else {
      const unsigned lower = k - 8;
      const std::uint32_t high = coder.symbol(model.large(k), code >> lower);
      code = high << lower | coder.bits(lower, code & ((1u << lower) - 1));
    }
    difference = static_cast<std::int32_t>(code >= 1u << (k - 1) ? code + 1 : code - (1u << k) + 1);
  }
  if constexpr (Coder::kEncodes) return value;
  const std::uint32_t sum = static_cast<std::uint32_t>(predicted) + static_cast<std::uint32_t>(difference);
  if constexpr (Bits == 32) return static_cast<std::int32_t>(sum);
  return static_cast<std::int32_t>(sum & static_cast<std::uint32_t>(kRange - 1));
}

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
