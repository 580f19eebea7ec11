// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "las/laz_items.h"

// The same items in version 1, as files of 2010 and 2011 have them. Read only.

namespace alidade::laz {
inline namespace ALIDADE_LAZ_SET {

class Point10V1 {
 public:
  static constexpr std::size_t kSize = 20;

  void start(const std::byte* first) {
    std::memcpy(m_last, first, kSize);
    m_differences = {};
    m_next = 0;
    renew(m_changed);
    renew(m_intensity);
    renew(m_scanAngle);
    renew(m_pointSource);
    m_returns.reset();
    m_classification.reset();
    m_userData.reset();
    renew(m_dx);
    renew(m_dy);
    renew(m_z);
  }

  void code(Decoder& coder, std::byte* at) {
    codeDifference(coder, m_dx, 0, 0);
    codeDifference(coder, m_dy, 1, std::min(m_dx.k, 19u));
    m_next = (m_next + 1) % 3;
    const unsigned k = (m_dx.k + m_dy.k) / 2;
    store(m_last + 8, codeInteger(coder, m_z, load<std::int32_t>(m_last + 8), std::min(k, 19u)));
    codeRest(coder, k);
    std::memcpy(at, m_last, kSize);
  }

 private:
  static std::int32_t median(const std::array<std::int32_t, 3>& v) {
    return std::max(std::min(v[0], v[1]), std::min(std::max(v[0], v[1]), v[2]));
  }

  template <int Contexts>
  void codeDifference(Decoder& coder, IntegerModel<32, Contexts>& model, std::size_t axis, unsigned context) {
    const std::int32_t difference = codeInteger(coder, model, median(m_differences[axis]), context);
    m_differences[axis][m_next] = difference;
    store(m_last + 4 * axis, plus(load<std::int32_t>(m_last + 4 * axis), difference));
  }

  void codeRest(Decoder& coder, unsigned k) {
    const unsigned changed = coder.symbol(m_changed);
    const auto wide = [&](auto& model, std::size_t field) {
      store(m_last + field, static_cast<std::uint16_t>(codeInteger(coder, model, load<std::uint16_t>(m_last + field), 0)));
    };
    const auto byteBy = [&](LazyModels<256, 256>& models, std::size_t field) {
      m_last[field] = static_cast<std::byte>(coder.symbol(models[byteAt(m_last + field)]));
    };
    if (changed & 32) wide(m_intensity, 12);
    if (changed & 16) byteBy(m_returns, 14);
    if (changed & 8) byteBy(m_classification, 15);
    if (changed & 4)
      m_last[16] = static_cast<std::byte>(codeInteger(coder, m_scanAngle, byteAt(m_last + 16), k < 3));
    if (changed & 2) byteBy(m_userData, 17);
    if (changed & 1) wide(m_pointSource, 18);
  }

  alignas(8) std::byte m_last[kSize];
  std::array<std::array<std::int32_t, 3>, 2> m_differences;
  unsigned m_next = 0;
  SymbolModel<64> m_changed;
  IntegerModel<16, 1> m_intensity, m_pointSource;
  IntegerModel<8, 2> m_scanAngle;
  LazyModels<256, 256> m_returns, m_classification, m_userData;
  IntegerModel<32, 1> m_dx;
  IntegerModel<32, 20> m_dy, m_z;
};

class GpsTimeV1 {
 public:
  static constexpr std::size_t kSize = 8;

  void start(const std::byte* first) {
    m_time = load<std::uint64_t>(first);
    m_difference = 0;
    m_extremes = 0;
    renew(m_multiple);
    renew(m_still);
    renew(m_numbers);
  }

  void code(Decoder& coder, std::byte* at) {
    if (m_difference == 0) {
      const unsigned symbol = coder.symbol(m_still);
      if (symbol == 1) {
        m_difference = codeInteger(coder, m_numbers, 0, 0);
        advance(m_difference);
      } else if (symbol == 2) {
        readFull(coder);
      }
    } else {
      const int multiple = static_cast<int>(coder.symbol(m_multiple));
      if (multiple < kMax - 2)
        codeMultiple(coder, multiple);
      else if (multiple == kMax - 2)
        readFull(coder);
    }
    store(at, m_time);
  }

 private:
  static constexpr int kMax = 512;

  void advance(std::int32_t difference) { m_time += static_cast<std::uint64_t>(std::int64_t{difference}); }

  void readFull(Decoder& coder) {
    const std::uint32_t low = coder.bits(32);
    m_time = std::uint64_t{coder.bits(32)} << 32 | low;
  }

  void codeMultiple(Decoder& coder, int multiple) {
    std::int32_t difference;
    if (multiple == 1) {
      m_difference = difference = codeInteger(coder, m_numbers, m_difference, 1);
      m_extremes = 0;
    } else if (multiple == 0) {
      difference = codeInteger(coder, m_numbers, m_difference / 4, 2);
      noteExtreme(difference);
    } else {
      difference = codeInteger(coder, m_numbers, times(multiple, m_difference), multiple < 10 ? 3 : multiple < 50 ? 4 : 5);
      if (multiple == kMax - 3) noteExtreme(difference);
    }
    advance(difference);
  }

  void noteExtreme(std::int32_t difference) {
    if (++m_extremes > 3) {
      m_difference = difference;
      m_extremes = 0;
    }
  }

  std::uint64_t m_time = 0;
  std::int32_t m_difference = 0, m_extremes = 0;
  SymbolModel<kMax> m_multiple;
  SymbolModel<3> m_still;
  IntegerModel<32, 6> m_numbers;
};

class Rgb12V1 {
 public:
  static constexpr std::size_t kSize = 6;

  void start(const std::byte* first) {
    std::memcpy(m_last, first, kSize);
    renew(m_used);
    renew(m_bytes);
  }

  void code(Decoder& coder, std::byte* at) {
    const unsigned used = coder.symbol(m_used);
    for (unsigned i = 0; i < kSize; ++i)
      if (used >> i & 1) m_last[i] = static_cast<std::byte>(codeInteger(coder, m_bytes, byteAt(m_last + i), i));
    std::memcpy(at, m_last, kSize);
  }

 private:
  std::byte m_last[kSize];
  SymbolModel<64> m_used;
  IntegerModel<8, 6> m_bytes;
};

class ExtraBytesV1 {
 public:
  explicit ExtraBytesV1(std::size_t size = 0) : m_last(size), m_widths(size) {}
  std::size_t size() const { return m_last.size(); }

  void start(const std::byte* first) {
    if (!m_last.empty()) std::memcpy(m_last.data(), first, m_last.size());
    for (auto& model : m_widths) renew(model);
    renew(m_numbers);
  }

  void code(Decoder& coder, std::byte* at) {
    for (std::size_t i = 0; i < m_last.size(); ++i) {
      // The bytes have widths of their own and share the models of the corrections.
      std::swap(m_numbers.width(0), m_widths[i]);
      at[i] = m_last[i] = static_cast<std::byte>(codeInteger(coder, m_numbers, byteAt(&m_last[i]), 0));
      std::swap(m_numbers.width(0), m_widths[i]);
    }
  }

 private:
  std::vector<std::byte> m_last;
  std::vector<SymbolModel<9>> m_widths;
  IntegerModel<8, 1> m_numbers;
};

}  // namespace ALIDADE_LAZ_SET
}  // namespace alidade::laz
