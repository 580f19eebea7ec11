// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include "las/laz_colour.h"
#include "las/laz_time.h"

// The items that make up a point of the formats 0-5, as the LASzip specification codes them in version 2
// (WAVEPACKET13: version 1, its only one). Every item holds its last value and its models; `code` follows the coder:
// it reads the record when encoding and fills it when decoding. Records are those of LAS: little endian, packed.
// The common items are coded in steps of about a symbol each (`eachStep`): the time of a symbol is waiting, a division, two
// looks into its model, a multiplication, and a processor sees too few instructions ahead to fill it with another
// chunk's point, but not with another chunk's symbol.

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

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
