// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace alidade {

/// Takes records apart into columns.
class RecordColumns {
 public:
  /// Records that are taken apart at a time.
  static constexpr std::size_t kBlock = 256;

  /// The columns' bytes a record, in which they stand one after the other; a record's bytes, a multiple of 8.
  RecordColumns(std::vector<std::size_t> widths, std::size_t recordBytes);

  std::span<const std::size_t> widths() const { return m_widths; }
  /// The columns of up to kBlock records, each to its own `out`, one value after the other.
  void take(const std::byte* const* records, std::size_t count, std::span<std::byte* const> out);

 private:
  /// Bytes of a column that stand in one word of the record: 1, 2, 4 or 8.
  struct Piece {
    std::size_t word, shift, bytes;
    std::size_t column, at;  ///< byte of the column's value
  };
  std::vector<std::size_t> m_widths;
  std::vector<Piece> m_pieces;
  std::size_t m_recordWords;
  std::vector<std::uint64_t> m_words;  ///< of a block, word by word
};

}  // namespace alidade
