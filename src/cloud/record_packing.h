// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cloud/point_schema.h"
#include "survey/point_records.h"

namespace alidade {

/// How a file's records become those of a store, without columns in between.
class RecordPacking {
 public:
  /// The schema covers the format.
  RecordPacking(const PointSchema& schema, const RecordFormat& format);

  /// Writes the schema's columns of `count` records, one after the other and zeros up to the record's end: record i at
  /// out + i * stride, with `room` bytes.
  void pack(const std::byte* records, std::size_t count, std::byte* out, std::size_t stride, std::size_t room) const;

 private:
  /// Bytes of the file's record that become part of a word of the store's.
  struct Copied {
    std::size_t at, bytes;  ///< bytes: 1, 2, 4, 6 or 8
    std::size_t word;
    int shift;
  };
  /// A byte whose bits become part of a word.
  struct Spread {
    std::size_t at, word;
    std::array<std::uint64_t, 256> values{};
  };
  /// What reaches over words, or is as wide as no number.
  struct Wide {
    std::size_t at, bytes, to;
  };
  void addCopied(std::size_t from, std::size_t bytes, std::size_t to);
  void addSpread(const RecordField::Part& part, std::size_t to);

  std::size_t m_recordBytes;
  std::vector<Copied> m_copied;
  std::vector<Spread> m_spread;
  std::vector<Wide> m_wide;
  bool m_widensColours = false;
  std::size_t m_coloursAt = 0;
};

}  // namespace alidade
