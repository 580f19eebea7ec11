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
/// Never fails: past the end it reads what stands there (see StreamEnd). Nothing
/// in here branches: what would be decided is as good as random, and a wrong guess costs as much as half a symbol.
class Decoder {
 public:
  static constexpr bool kEncodes = false;

  Decoder() = default;
  /// Four bytes must be readable.
  explicit Decoder(const std::byte* at) : m_at(at + 4) {
    // The format's values are below the length; no damaged one shall be otherwise.
    m_value = std::min(bigEndian(at), length() - 1);
  }

  /// Behind the last byte taken.
  const std::byte* position() const { return m_at; }
  void goBackTo(const std::byte* limit) { m_at = std::min(m_at, limit); }

  template <int Capacity>
  [[gnu::always_inline]] unsigned symbol(SymbolModel<Capacity>& model, unsigned = 0) {
    const std::uint32_t step = length() >> 15;
    const auto [symbol, low, next] = model.find(value() / step);
    // The last symbol has all that is left.
    const std::uint32_t isLast = 0 - (next >> 15), left = length() - kBeyond * step;
    narrow(low * step, (next - low) * step + (left & isLast));
    model.learn(symbol);
    return symbol;
  }

  [[gnu::always_inline]] unsigned bit(BitModel& model, unsigned = 0) {
    const std::uint32_t zeros = model.zeroShare() * (length() >> 13);
    const unsigned bit = value() >= zeros;
    const std::uint32_t isOne = 0 - bit;
    narrow(zeros & isOne, ((length() - zeros) & isOne) | (zeros & ~isOne));
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
    const std::uint32_t step = length() >> count, number = value() / step;
    narrow(number * step, step);
    return number & ((1u << count) - 1);
  }

  static std::uint32_t bigEndian(const std::byte* at) {
    std::uint32_t bytes;
    std::memcpy(&bytes, at, 4);
    return __builtin_bswap32(bytes);
  }

  std::uint32_t value() const { return static_cast<std::uint32_t>(m_value); }
  std::uint32_t length() const { return static_cast<std::uint32_t>(m_length); }

  /// Goes on with the part from `low` of this length, and takes in as many bytes as the length has lost.
  [[gnu::always_inline]] void narrow(std::uint32_t low, std::uint32_t length) {
    const unsigned shift = static_cast<unsigned>(__builtin_clz(length)) & 24u;
    const auto taken = static_cast<std::uint32_t>(std::uint64_t{bigEndian(m_at)} << shift >> 32);
    m_value = (value() - low) << shift | taken;
    m_length = length << shift;
    m_at += shift >> 3;
  }

  // Below 2^32. In words of their own: compilers pack two halves of a word into one register, and unpack them for each use.
  std::uint64_t m_value = 0, m_length = 0xFFFFFFFFu;
  const std::byte* m_at = nullptr;
};

/// The end of a compressed stream; kPadding bytes behind it must be readable.
class StreamEnd {
 public:
  StreamEnd() = default;
  explicit StreamEnd(std::span<const std::byte> stream) : m_end(stream.data() + stream.size()) {}

  bool isBefore(const Decoder& decoder) const { return decoder.position() > m_end; }
  /// To be called after each point: goes back to the end, or a little behind it, where it was passed.
  void hold(Decoder& decoder) const { decoder.goBackTo(m_end + 4); }

 private:
  const std::byte* m_end = nullptr;
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

/// Runs `body`, which is rare, out of line and with a copy of the decoder: one whose address is never given away stays in
/// registers.
template <class Coder, class Body>
[[gnu::noinline, gnu::cold]] void runAside(Coder& coder, const Body& body) {
  body(coder);
}
template <class Coder, class Body>
[[gnu::always_inline]] inline void codeAside(Coder& coder, const Body& body) {
  if constexpr (Coder::kEncodes) {
    body(coder);
  } else {
    Coder copy = coder;
    runAside(copy, body);
    coder = copy;
  }
}

/// Codes `value`, a number of Bits bits, as its difference from `predicted`. In two steps, so that another decoder can
/// take its turn between them; first the number k of bits that the difference takes, which is left in `model.k`.
template <class Coder, int Bits, int Contexts>
[[gnu::always_inline]] inline void codeWidth(Coder& coder, IntegerModel<Bits, Contexts>& model, std::int32_t predicted,
                                             unsigned context, std::int32_t value = 0) {
  constexpr std::int64_t kRange = std::int64_t{1} << Bits;
  unsigned k = 0;
  if constexpr (Coder::kEncodes) {
    std::int64_t difference = Bits == 32 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(value) -
                                                                     static_cast<std::uint32_t>(predicted))
                                         : std::int64_t{value} - predicted;
    if (Bits < 32 && difference < -kRange / 2) difference += kRange;
    if (Bits < 32 && difference > kRange / 2 - 1) difference -= kRange;
    // k bits hold the differences from -(2^k - 1) to -2^(k-1) and from 2^(k-1) + 1 to 2^k; no bits 0 and 1.
    k = static_cast<unsigned>(std::bit_width(static_cast<std::uint32_t>(difference <= 0 ? -difference : difference - 1)));
    model.code = static_cast<std::uint32_t>(k == 0 ? difference : difference < 0 ? difference + (std::int64_t{1} << k) - 1 : difference - 1);
  }
  model.predicted = predicted;
  model.k = coder.symbol(model.width(context), k);
}

/// Then the difference. Returns the value.
template <class Coder, int Bits, int Contexts>
[[gnu::always_inline]] inline std::int32_t codeCorrection(Coder& coder, IntegerModel<Bits, Contexts>& model) {
  const unsigned k = model.k;
  std::uint32_t code = model.code;
  std::int32_t difference;
  if (k == 0) {
    difference = static_cast<std::int32_t>(coder.bit(model.bit(), code));
  } else if (Bits == 32 && k == 32) {
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
    // The lower half of the codes are the negative differences. Not as a branch: the sign is as good as random.
    const std::uint32_t isNegative = ~code >> (k - 1) & 1;
    difference = static_cast<std::int32_t>(code + 1 - (isNegative << k));
  }
  const std::uint32_t sum = static_cast<std::uint32_t>(model.predicted) + static_cast<std::uint32_t>(difference);
  return static_cast<std::int32_t>(sum & (0xFFFFFFFFu >> (32 - Bits)));
}

/// Both steps.
template <class Coder, int Bits, int Contexts>
[[gnu::always_inline]] inline std::int32_t codeInteger(Coder& coder, IntegerModel<Bits, Contexts>& model,
                                                       std::int32_t predicted, unsigned context,
                                                       std::int32_t value = 0) {
  codeWidth(coder, model, predicted, context, value);
  return codeCorrection(coder, model);
}

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
