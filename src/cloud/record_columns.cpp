// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/record_columns.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/widest.h"

namespace alidade {

namespace {

constexpr std::size_t kBlock = RecordColumns::kBlock;

/// The words of records, word by word.
template <class Count>
void takeWords(const std::byte* const* records, std::size_t count, Count recordWords, std::uint64_t* words) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t w = 0; w < recordWords; ++w) std::memcpy(&words[w * kBlock + i], records[i] + 8 * w, 8);
}

/// Numbers out of words, one after the other.
ALIDADE_WIDEST void take1(const std::uint64_t* words, std::size_t shift, std::size_t count, std::byte* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::byte>(words[i] >> shift);
}
ALIDADE_WIDEST void take2(const std::uint64_t* words, std::size_t shift, std::size_t count, std::byte* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::uint16_t>(words[i] >> shift);
    std::memcpy(out + 2 * i, &number, sizeof number);
  }
}
ALIDADE_WIDEST void take4(const std::uint64_t* words, std::size_t shift, std::size_t count, std::byte* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::uint32_t>(words[i] >> shift);
    std::memcpy(out + 4 * i, &number, sizeof number);
  }
}

/// The same, `stride` bytes apart.
template <class Number>
void takeApart(const std::uint64_t* words, std::size_t shift, std::size_t count, std::byte* out, std::size_t stride) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = static_cast<Number>(words[i] >> shift);
    std::memcpy(out + i * stride, &number, sizeof number);
  }
}

void takePiece(const std::uint64_t* words, std::size_t shift, std::size_t bytes, std::size_t count, std::byte* out, std::size_t stride) {
  const bool dense = bytes == stride;
  switch (bytes) {
    case 1: return dense ? take1(words, shift, count, out) : takeApart<std::uint8_t>(words, shift, count, out, stride);
    case 2: return dense ? take2(words, shift, count, out) : takeApart<std::uint16_t>(words, shift, count, out, stride);
    case 4: return dense ? take4(words, shift, count, out) : takeApart<std::uint32_t>(words, shift, count, out, stride);
    default:
      if (dense) std::memcpy(out, words, 8 * count);
      else takeApart<std::uint64_t>(words, shift, count, out, stride);
  }
}

}  // namespace

RecordColumns::RecordColumns(std::vector<std::size_t> widths, std::size_t recordBytes)
    : m_widths(std::move(widths)), m_recordWords(recordBytes / 8), m_words(m_recordWords * kBlock) {
  std::size_t from = 0;
  for (std::size_t column = 0; column < m_widths.size(); ++column) {
    for (std::size_t at = 0; at < m_widths[column];) {
      const std::size_t bytes = std::bit_floor(std::min(m_widths[column] - at, 8 - from % 8));
      m_pieces.push_back({from / 8, from % 8 * 8, bytes, column, at});
      at += bytes, from += bytes;
    }
  }
  assert(from <= recordBytes && recordBytes % 8 == 0);
}

void RecordColumns::take(const std::byte* const* records, std::size_t count, std::span<std::byte* const> out) {
  switch (m_recordWords) {
    case 1: takeWords(records, count, std::integral_constant<std::size_t, 1>(), m_words.data()); break;
    case 2: takeWords(records, count, std::integral_constant<std::size_t, 2>(), m_words.data()); break;
    case 3: takeWords(records, count, std::integral_constant<std::size_t, 3>(), m_words.data()); break;
    case 4: takeWords(records, count, std::integral_constant<std::size_t, 4>(), m_words.data()); break;
    case 5: takeWords(records, count, std::integral_constant<std::size_t, 5>(), m_words.data()); break;
    default: takeWords(records, count, m_recordWords, m_words.data());
  }
  for (const Piece& piece : m_pieces)
    takePiece(m_words.data() + piece.word * kBlock, piece.shift, piece.bytes, count, out[piece.column] + piece.at, m_widths[piece.column]);
}

}  // namespace alidade
