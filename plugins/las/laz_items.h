// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdlib>
#include <vector>

#include "las/laz_coder.h"

// The items that make up a point of the formats 0-5, as the LASzip specification codes them in version 2
// (WAVEPACKET13: version 1, its only one). Every item holds its last value and its models; `code` follows the coder:
// it reads the record when encoding and fills it when decoding. Records are those of LAS: little endian, packed.

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

/// LAS 1.2 core record, 20 bytes: POINT10 version 2.
class Point10 {
 public:
  static constexpr std::size_t kSize = 20;

  void start(const std::byte* first) {
    m_last = Fields(first);
    m_intensities.fill(0);
    m_heights.fill(0);
    m_xMedians.fill({});
    m_yMedians.fill({});
    renew(m_changed);
    renew(m_intensity);
    for (auto& model : m_scanAngle) renew(model);
    renew(m_pointSource);
    m_returns.reset();
    m_classification.reset();
    m_userData.reset();
    renew(m_dx);
    renew(m_dy);
    renew(m_z);
  }

  /// The steps of a record at `at`, in their order: each codes a symbol or two.
  template <class Visit>
  static void eachStep(const Visit& visit) {
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeChanged(coder, at); });
    visit([](Point10& p, auto& coder, std::byte*) { p.codeReturns(coder); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeOtherAttributes(coder, at); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeXWidth(coder, at); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeX(coder, at); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeYWidth(coder, at); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeY(coder, at); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeZWidth(coder, at); });
    visit([](Point10& p, auto& coder, std::byte* at) { p.codeZ(coder, at); });
  }

 private:
  /// The record's fields but z, which is predicted from its height level.
  struct Fields {
    Fields() = default;
    explicit Fields(const std::byte* at)
        : x(load<std::int32_t>(at)),
          y(load<std::int32_t>(at + 4)),
          intensity(load<std::uint16_t>(at + 12)),
          pointSource(load<std::uint16_t>(at + 18)),
          returns(byteAt(at + 14)),
          classification(byteAt(at + 15)),
          scanAngle(byteAt(at + 16)),
          userData(byteAt(at + 17)) {}
    std::int32_t x = 0, y = 0;
    std::uint16_t intensity = 0, pointSource = 0;
    std::uint8_t returns = 0, classification = 0, scanAngle = 0, userData = 0;
  };

  template <class Coder>
  void codeChanged(Coder& coder, const std::byte* at) {
    if constexpr (Coder::kEncodes) {
      m_now = Fields(at);
      m_changedNow = (m_now.returns != m_last.returns) << 5 |
                     (m_now.intensity != m_intensities[returnContext(m_now.returns)]) << 4 |
                     (m_now.classification != m_last.classification) << 3 | (m_now.scanAngle != m_last.scanAngle) << 2 |
                     (m_now.userData != m_last.userData) << 1 | (m_now.pointSource != m_last.pointSource);
    }
    m_changedNow = coder.symbol(m_changed, m_changedNow);
  }

  template <class Coder>
  void codeReturns(Coder& coder) {
    if (m_changedNow & 32) codeByte(coder, m_returns, m_last.returns, m_now.returns);
    m_context = returnContext(m_last.returns);
    if (m_changedNow & 16)
      codeWidth(coder, m_intensity, m_intensities[m_context], std::min(m_context, 3u), m_now.intensity);
  }

  template <class Coder>
  void codeOtherAttributes(Coder& coder, std::byte* at) {
    if (m_changedNow & 16) m_intensities[m_context] = static_cast<std::uint16_t>(codeCorrection(coder, m_intensity));
    if (m_changedNow & 15) codeAside(coder, [&](Coder& local) { codeRareAttributes(local); });
    if constexpr (!Coder::kEncodes) {
      store(at + 12, m_intensities[m_context]);
      store(at + 14, m_last.returns);
      store(at + 15, m_last.classification);
      store(at + 16, m_last.scanAngle);
      store(at + 17, m_last.userData);
      store(at + 18, m_last.pointSource);
    }
  }

  template <class Coder>
  void codeRareAttributes(Coder& coder) {
    if (m_changedNow & 8) codeByte(coder, m_classification, m_last.classification, m_now.classification);
    if (m_changedNow & 4) {
      const auto difference = static_cast<std::uint8_t>(m_now.scanAngle - m_last.scanAngle);
      m_last.scanAngle += static_cast<std::uint8_t>(coder.symbol(m_scanAngle[m_last.returns >> 6 & 1], difference));
    }
    if (m_changedNow & 2) codeByte(coder, m_userData, m_last.userData, m_now.userData);
    if (m_changedNow & 1)
      m_last.pointSource =
          static_cast<std::uint16_t>(codeInteger(coder, m_pointSource, m_last.pointSource, 0, m_now.pointSource));
  }

  template <class Coder>
  void codeXWidth(Coder& coder, const std::byte* at) {
    codeStepWidth(coder, m_dx, m_xMedians[m_context], isSingle(), m_last.x, at);
  }
  template <class Coder>
  void codeX(Coder& coder, std::byte* at) {
    codeStep(coder, m_dx, m_xMedians[m_context], m_last.x, at);
  }

  template <class Coder>
  void codeYWidth(Coder& coder, const std::byte* at) {
    codeStepWidth(coder, m_dy, m_yMedians[m_context], isSingle() + evenUpTo(m_dx.k, 20), m_last.y, at + 4);
  }
  template <class Coder>
  void codeY(Coder& coder, std::byte* at) {
    codeStep(coder, m_dy, m_yMedians[m_context], m_last.y, at + 4);
  }

  template <class Coder>
  void codeZWidth(Coder& coder, const std::byte* at) {
    std::int32_t value = 0;
    if constexpr (Coder::kEncodes) value = load<std::int32_t>(at + 8);
    codeWidth(coder, m_z, height(), isSingle() + evenUpTo((m_dx.k + m_dy.k) / 2, 18), value);
  }
  template <class Coder>
  void codeZ(Coder& coder, std::byte* at) {
    height() = codeCorrection(coder, m_z);
    if constexpr (!Coder::kEncodes) store(at + 8, height());
  }

  /// How far x or y has come since the last point.
  template <class Coder, int Contexts>
  void codeStepWidth(Coder& coder, IntegerModel<32, Contexts>& model, const StreamingMedian& median,
                                            unsigned context, std::int32_t last, const std::byte* at) {
    std::int32_t step = 0;
    if constexpr (Coder::kEncodes) step = minus(load<std::int32_t>(at), last);
    codeWidth(coder, model, median.get(), context, step);
  }
  template <class Coder, int Contexts>
  void codeStep(Coder& coder, IntegerModel<32, Contexts>& model, StreamingMedian& median,
                                       std::int32_t& last, std::byte* at) {
    const std::int32_t step = codeCorrection(coder, model);
    last = plus(last, step);
    median.add(step);
    if constexpr (!Coder::kEncodes) store(at, last);
  }

  /// The last of the same height level: how many returns follow.
  std::int32_t& height() { return m_heights[std::abs((m_last.returns >> 3 & 7) - (m_last.returns & 7))]; }
  unsigned isSingle() const { return (m_last.returns >> 3 & 7) == 1; }

  /// Number of returns and return number as one context of 16; row: of how many, column: which.
  static unsigned returnContext(unsigned returns) {
    static constexpr std::uint8_t kMap[8][8] = {
        {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},     {13, 1, 2, 4, 7, 11, 11, 10},
        {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},    {10, 10, 11, 12, 13, 14, 14, 13},
        {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15}};
    return kMap[returns >> 3 & 7][returns & 7];
  }

  Fields m_last, m_now;  ///< m_now: encoding only
  unsigned m_changedNow = 0, m_context = 0;
  std::array<std::uint16_t, 16> m_intensities;
  std::array<std::int32_t, 8> m_heights;
  std::array<StreamingMedian, 16> m_xMedians, m_yMedians;
  SymbolModel<64> m_changed;
  IntegerModel<16, 4> m_intensity;
  std::array<SymbolModel<256>, 2> m_scanAngle;
  IntegerModel<16, 1> m_pointSource;
  LazyModels<256, 256> m_returns, m_classification, m_userData;
  IntegerModel<32, 2> m_dx;
  IntegerModel<32, 22> m_dy;
  IntegerModel<32, 20> m_z;
};

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

/// Red, green, blue of 16 bits: RGB12 version 2; RGB14 has the same code with other contexts.
struct RgbModels {
  SymbolModel<128> used;
  std::array<SymbolModel<256>, 6> differences;
  void start() {
    renew(used);
    for (auto& model : differences) renew(model);
  }
};

/// One colour, coded against the last. The upper and lower bytes go their own ways; green and blue are predicted from
/// what red and green did; a grey point says so in one bit. Bytes are numbered as the record has them: red's lower,
/// red's upper, green's lower ...
class RgbCoding {
 public:
  /// The steps in their order: each codes a symbol. To be started before, finished behind.
  template <class Visit>
  static void eachStep(const Visit& visit) {
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeUsed(coder, models); });
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeByte<0>(coder, models); });
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeByte<1>(coder, models); });
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeByte<2>(coder, models); });
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeByte<4>(coder, models); });
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeByte<3>(coder, models); });
    visit([](RgbCoding& c, auto& coder, RgbModels& models) { c.codeByte<5>(coder, models); });
  }

  /// `rgb` is read when encoding.
  void start(const std::uint16_t* last, const std::uint16_t* rgb) {
    for (int i = 0; i < 3; ++i) {
      m_last[2 * i] = last[i] & 0xFF, m_last[2 * i + 1] = last[i] >> 8;
      m_now[2 * i] = rgb[i] & 0xFF, m_now[2 * i + 1] = rgb[i] >> 8;
    }
  }
  void finish(std::uint16_t* last) {
    for (int i = 0; i < 3; ++i) last[i] = static_cast<std::uint16_t>(m_now[2 * i] | m_now[2 * i + 1] << 8);
  }

 private:
  static constexpr unsigned kColoured = 64;

  template <class Coder>
  void codeUsed(Coder& coder, RgbModels& models) {
    if constexpr (Coder::kEncodes) {
      m_used = 0;
      for (int i = 0; i < 6; ++i) m_used |= (m_now[i] != m_last[i]) << i;
      if (m_now[0] != m_now[2] || m_now[0] != m_now[4] || m_now[1] != m_now[3] || m_now[1] != m_now[5]) m_used |= kColoured;
    }
    m_used = coder.symbol(models.used, m_used);
  }

  template <int I, class Coder>
  void codeByte(Coder& coder, RgbModels& models) {
    if (I >= 2 && !(m_used & kColoured)) {
      m_now[I] = m_now[I % 2];
      return;
    }
    if (!(m_used >> I & 1)) {
      m_now[I] = m_last[I];
      return;
    }
    int predicted = m_last[I];
    if (I >= 2) {
      int step = m_now[I % 2] - m_last[I % 2];
      if (I >= 4) step = (step + m_now[I % 2 + 2] - m_last[I % 2 + 2]) / 2;
      predicted = clampToByte(predicted + step);
    }
    const unsigned difference = coder.symbol(models.differences[I], static_cast<std::uint8_t>(m_now[I] - predicted));
    m_now[I] = static_cast<std::uint8_t>(predicted + static_cast<int>(difference));
  }

  unsigned m_used = 0;
  int m_last[6], m_now[6];
};

/// Codes `rgb` (filled when decoding) against `last`, which follows.
template <class Coder>
[[gnu::always_inline]] inline void codeRgb(Coder& coder, RgbModels& models, std::uint16_t* last, std::uint16_t* rgb) {
  RgbCoding coding;
  coding.start(last, rgb);
  RgbCoding::eachStep([&](const auto& step) { step(coding, coder, models); });
  coding.finish(last);
  for (int i = 0; i < 3; ++i) rgb[i] = last[i];
}

class Rgb12 {
 public:
  static constexpr std::size_t kSize = 6;

  void start(const std::byte* first) {
    std::memcpy(m_last, first, kSize);
    m_models.start();
  }

  template <class Visit>
  static void eachStep(const Visit& visit) {
    visit([](Rgb12& c, auto&, std::byte* at) { c.startCoding(at); });
    RgbCoding::eachStep([&](const auto& step) {
      visit([&step](Rgb12& c, auto& coder, std::byte*) { step(c.m_coding, coder, c.m_models); });
    });
    visit([](Rgb12& c, auto&, std::byte* at) {
      c.m_coding.finish(c.m_last);
      // One by one as they were written just now: a load of more than that would have to wait for the cache.
      for (int i = 0; i < 3; ++i) store(at + 2 * i, c.m_last[i]);
    });
  }

 private:
  void startCoding(const std::byte* at) {
    std::uint16_t rgb[3];
    std::memcpy(rgb, at, kSize);
    m_coding.start(m_last, rgb);
  }

  std::uint16_t m_last[3];
  RgbCoding m_coding;
  RgbModels m_models;
};

/// Where a point's wave form stands: WAVEPACKET13 version 1; WAVEPACKET14 has the same code.
class WavePacket {
 public:
  static constexpr std::size_t kSize = 29;

  void start(const std::byte* first) {
    std::memcpy(m_last, first, kSize);
    startModels();
  }
  void startModels() {
    m_lastOffsetKind = 0;
    m_lastOffsetDifference = 0;
    renew(m_index);
    for (auto& model : m_offsetKind) renew(model);
    renew(m_offsetDifference);
    renew(m_size);
    renew(m_returnPoint);
    renew(m_direction);
  }

  template <class Coder>
  void code(Coder& coder, std::byte* at) {
    codeAgainst(coder, m_last, at);
  }
  std::byte* last() { return m_last; }

  /// Against `last`, which follows.
  template <class Coder>
  void codeAgainst(Coder& coder, std::byte* last, std::byte* at) {
    std::byte now[kSize];
    std::memcpy(now, Coder::kEncodes ? at : last, kSize);
    now[0] = static_cast<std::byte>(coder.symbol(m_index, byteAt(now)));
    const auto lastOffset = load<std::uint64_t>(last + 1);
    const auto lastSize = load<std::uint32_t>(last + 9);
    auto offset = load<std::uint64_t>(now + 1);
    const auto wide = static_cast<std::int64_t>(offset - lastOffset);
    unsigned kind = wide == 0                                 ? 0
                    : offset == lastOffset + lastSize         ? 1
                    : wide == static_cast<std::int32_t>(wide) ? 2
                                                              : 3;
    m_lastOffsetKind = kind = coder.symbol(m_offsetKind[m_lastOffsetKind], kind);
    if (kind == 0) {
      offset = lastOffset;
    } else if (kind == 1) {
      offset = lastOffset + lastSize;
    } else if (kind == 2) {
      m_lastOffsetDifference = codeInteger(coder, m_offsetDifference, m_lastOffsetDifference, 0,
                                           static_cast<std::int32_t>(wide));
      offset = lastOffset + static_cast<std::uint64_t>(std::int64_t{m_lastOffsetDifference});
    } else {
      const std::uint32_t low = coder.bits(32, static_cast<std::uint32_t>(offset));
      offset = std::uint64_t{coder.bits(32, static_cast<std::uint32_t>(offset >> 32))} << 32 | low;
    }
    store(now + 1, offset);
    const auto number = [&](auto& model, std::size_t field, unsigned context) {
      store(now + field, codeInteger(coder, model, load<std::int32_t>(last + field), context,
                                     load<std::int32_t>(now + field)));
    };
    number(m_size, 9, 0);
    number(m_returnPoint, 13, 0);
    for (unsigned axis = 0; axis < 3; ++axis) number(m_direction, 17 + 4 * axis, axis);
    std::memcpy(last, now, kSize);
    if constexpr (!Coder::kEncodes) std::memcpy(at, now, kSize);
  }

 private:
  std::byte m_last[kSize];
  unsigned m_lastOffsetKind = 0;
  std::int32_t m_lastOffsetDifference = 0;
  SymbolModel<256> m_index;
  std::array<SymbolModel<4>, 4> m_offsetKind;
  IntegerModel<32, 1> m_offsetDifference, m_size, m_returnPoint;
  IntegerModel<32, 3> m_direction;
};

/// Extra bytes, each against its last: BYTE version 2.
class ExtraBytes {
 public:
  explicit ExtraBytes(std::size_t size = 0) : m_last(size), m_models(size) {}
  std::size_t size() const { return m_last.size(); }

  void start(const std::byte* first) {
    if (!m_last.empty()) std::memcpy(m_last.data(), first, m_last.size());
    for (auto& model : m_models) renew(model);
  }

  template <class Coder>
  void code(Coder& coder, std::byte* at) {
    for (std::size_t i = 0; i < m_last.size(); ++i) {
      std::uint8_t difference = 0;
      if constexpr (Coder::kEncodes) difference = static_cast<std::uint8_t>(byteAt(at + i) - byteAt(&m_last[i]));
      m_last[i] = static_cast<std::byte>(byteAt(&m_last[i]) + coder.symbol(m_models[i], difference));
      if constexpr (!Coder::kEncodes) at[i] = m_last[i];
    }
  }

 private:
  std::vector<std::byte> m_last;
  std::vector<SymbolModel<256>> m_models;
};

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
