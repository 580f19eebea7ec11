// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/laz_fields.h"

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

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

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
