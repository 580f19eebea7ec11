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

/// How a file's records become those of a store, without columns in between: every sixteen bytes of a store's record are
/// put together in a register.
class RecordPacking {
 public:
  /// The schema covers the format. `room`: bytes of a store's record for the schema's columns, a multiple of 8.
  RecordPacking(const PointSchema& schema, const RecordFormat& format, std::size_t room);

  /// Writes the schema's columns of `count` records, one after the other and zeros up to the room's end: those of record
  /// rows[i] of `records` at out + i * stride.
  void pack(const std::byte* records, const std::uint32_t* rows, std::size_t count, std::byte* out, std::size_t stride) const;

  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  /// Bytes of a stretch of the file's record, each where it belongs.
  struct Shuffle {
    std::size_t from;
    Bytes take, keep;
  };
  /// A byte whose bits become part of a word.
  struct Spread {
    std::size_t at;
    std::array<std::uint64_t, 256> values{};
  };
  /// Sixteen bytes of the store's record, or the last eight.
  struct Lane {
    std::vector<Shuffle> shuffles;
    std::array<std::vector<Spread>, 2> spreads;  ///< of each word
    std::size_t bytes = 16;
  };

 private:
  struct Copied {
    std::size_t from, to;  ///< a byte
  };
  void addCopied(std::vector<Copied> bytes, Lane& lane) const;
  void addSpread(const RecordField::Part& part, std::size_t to);

  std::size_t m_recordBytes;
  std::vector<Lane> m_lanes;
  bool m_widensColours = false;
  std::size_t m_coloursAt = 0;
};

}  // namespace alidade
