// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/laz_fields.h"

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

/// GPS time: GPSTIME11 version 2, and with Layered the time layer of POINT14 version 3, which leaves
/// unchanged times to another flag. Four sequences run side by side; most times are a small multiple
/// of their sequence's last difference farther on.
template <bool Layered>
class GpsTime {
 public:
  static constexpr std::size_t kSize = 8;

  void start(const std::byte* first) { start(load<std::uint64_t>(first)); }
  void start(std::uint64_t first) {
    m_sequence = m_next = 0;
    m_times = {first, 0, 0, 0};
    m_differences = {};
    m_extremes = {};
    renew(m_multiple);
    renew(m_still);
    renew(m_numbers);
  }

  template <class Visit>
  static void eachStep(const Visit& visit) {
    visit([](GpsTime& t, auto& coder, std::byte* at) { t.codeKind(coder, at); });
    visit([](GpsTime& t, auto& coder, std::byte*) { t.codeMultipleWidth(coder); });
    visit([](GpsTime& t, auto& coder, std::byte* at) { t.codeMultiple(coder, at); });
  }

  /// All steps.
  template <class Coder>
  void code(Coder& coder, std::byte* at) {
    eachStep([&](const auto& step) { step(*this, coder, at); });
  }

 private:
  static constexpr int kMost = 500, kLeast = -10, kNone = kMost + 1;
  // Symbols behind the multiples 0..500 and -1..-10.
  static constexpr int kUnchanged = kMost - kLeast + 1;              // not Layered
  static constexpr int kFull = kUnchanged + (Layered ? 0 : 1);       // then three: another sequence
  // Symbols where the sequence has stood still.
  static constexpr int kStillShort = Layered ? 0 : 1, kStillFull = kStillShort + 1;

  std::int32_t& difference() { return m_differences[m_sequence]; }

  /// A difference that no multiple fits is taken as the new one when it has come four times.
  void noteExtreme(std::int32_t current) {
    if (++m_extremes[m_sequence] > 3) {
      difference() = current;
      m_extremes[m_sequence] = 0;
    }
  }

  template <class Coder>
  void codeShort(Coder& coder, std::int32_t current) {
    difference() = codeInteger(coder, m_numbers, 0, 0, current);
    m_times[m_sequence] += static_cast<std::uint64_t>(std::int64_t{difference()});
    m_extremes[m_sequence] = 0;
  }

  template <class Coder>
  void codeFull(Coder& coder, std::uint64_t time) {
    m_next = (m_next + 1) & 3;
    const auto upper = static_cast<std::int32_t>(m_times[m_sequence] >> 32);
    const auto high = static_cast<std::uint32_t>(
        codeInteger(coder, m_numbers, upper, 8, static_cast<std::int32_t>(time >> 32)));
    const auto low = coder.bits(32, static_cast<std::uint32_t>(time));
    m_sequence = m_next;
    m_times[m_sequence] = std::uint64_t{high} << 32 | low;
    difference() = 0;
    m_extremes[m_sequence] = 0;
  }

  /// Times that are no multiple farther on are done with here.
  template <class Coder>
  void codeKind(Coder& coder, const std::byte* at) {
    m_multipleNow = kNone;
    if constexpr (Coder::kEncodes) {
      encode(coder, load<std::uint64_t>(at));
    } else if (difference() == 0) {
      codeAside(coder, [&](Decoder& local) { decodeStill(local, 4); });
    } else {
      const auto symbol = static_cast<int>(coder.symbol(m_multiple));
      if (symbol < kUnchanged)
        m_multipleNow = symbol <= kMost ? symbol : kMost - symbol;
      else if (symbol >= kFull)
        codeAside(coder, [&](Decoder& local) { decodeOther(local, symbol - kFull, 4); });
    }
  }

  /// A time `m_multipleNow` differences farther on, by more or less.
  template <class Coder>
  void codeMultipleWidth(Coder& coder) {
    const int multiple = m_multipleNow;
    if (multiple == kNone) return;
    const unsigned context = multiple == 1       ? 1
                             : multiple == 0     ? 7
                             : multiple == kMost ? 4
                             : multiple >= 10    ? 3
                             : multiple > 0      ? 2
                             : multiple > kLeast ? 5
                                                 : 6;
    codeWidth(coder, m_numbers, times(multiple, difference()), context, m_now);
  }

  template <class Coder>
  void codeMultiple(Coder& coder, std::byte* at) {
    if (m_multipleNow != kNone) {
      const std::int32_t current = codeCorrection(coder, m_numbers);
      m_times[m_sequence] += static_cast<std::uint64_t>(std::int64_t{current});
      if (m_multipleNow == 1)
        m_extremes[m_sequence] = 0;
      else if (m_multipleNow == 0 || m_multipleNow == kMost || m_multipleNow == kLeast)
        noteExtreme(current);
    }
    if constexpr (!Coder::kEncodes) store(at, m_times[m_sequence]);
  }

  /// Where the sequence has stood still. One change of sequence a time is all an encoder writes; damaged bytes shall not
  /// make a loop: at most `changes`.
  void decodeStill(Decoder& coder, int changes) {
    const auto symbol = static_cast<int>(coder.symbol(m_still));
    if (symbol < kStillShort) return;
    if (symbol == kStillShort) return codeShort(coder, 0);
    decodeOther(coder, symbol - kStillFull, changes);
  }

  /// `sequences` on; 0: a whole new time.
  void decodeOther(Decoder& coder, int sequences, int changes) {
    if (sequences == 0) return codeFull(coder, 0);
    m_sequence = (m_sequence + sequences) & 3;
    if (changes == 1) return;
    if (difference() == 0) return decodeStill(coder, changes - 1);
    const auto symbol = static_cast<int>(coder.symbol(m_multiple));
    if (symbol < kUnchanged)
      m_multipleNow = symbol <= kMost ? symbol : kMost - symbol;
    else if (symbol >= kFull)
      decodeOther(coder, symbol - kFull, changes - 1);
  }

  template <class Coder>
  void encode(Coder& coder, std::uint64_t time) {
    for (;;) {
      const auto wide = static_cast<std::int64_t>(time - m_times[m_sequence]);
      const bool fits = wide == static_cast<std::int32_t>(wide);
      const auto current = static_cast<std::int32_t>(wide);
      const bool still = difference() == 0;
      if (!Layered && wide == 0) {
        if (still)
          coder.symbol(m_still, 0);
        else
          coder.symbol(m_multiple, kUnchanged);
        return;
      }
      if (fits && still) {
        coder.symbol(m_still, kStillShort);
        return codeShort(coder, current);
      }
      if (fits) {
        const float ratio = std::clamp(static_cast<float>(current) / static_cast<float>(difference()),
                                       static_cast<float>(kLeast), static_cast<float>(kMost));
        const int multiple = static_cast<int>(ratio >= 0 ? ratio + 0.5f : ratio - 0.5f);
        coder.symbol(m_multiple, static_cast<unsigned>(multiple >= 0 ? multiple : kMost - multiple));
        m_multipleNow = multiple;
        m_now = current;
        return;
      }
      const int other = sequenceNear(time);
      if (still)
        coder.symbol(m_still, static_cast<unsigned>(kStillFull + other));
      else
        coder.symbol(m_multiple, static_cast<unsigned>(kFull + other));
      if (other == 0) return codeFull(coder, time);
      m_sequence = (m_sequence + other) & 3;
    }
  }

  /// How many sequences on is one whose time is within 32 bits of this; 0: none.
  int sequenceNear(std::uint64_t time) const {
    for (int i = 1; i < 4; ++i) {
      const auto wide = static_cast<std::int64_t>(time - m_times[(m_sequence + i) & 3]);
      if (wide == static_cast<std::int32_t>(wide)) return i;
    }
    return 0;
  }

  int m_sequence = 0, m_next = 0;
  int m_multipleNow = kNone;   ///< of the point that is being coded
  std::int32_t m_now = 0;      ///< its difference; encoding only
  std::array<std::uint64_t, 4> m_times;  ///< the doubles' bits
  std::array<std::int32_t, 4> m_differences, m_extremes;
  SymbolModel<kFull + 4> m_multiple;
  SymbolModel<kStillFull + 4> m_still;
  IntegerModel<32, 9> m_numbers;
};

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
