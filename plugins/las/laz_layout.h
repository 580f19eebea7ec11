// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "las/byte_source.h"
#include "las/laz_chunk.h"

namespace alidade {

struct LasHeader;

/// What the "laszip encoded" record 22204 says of a compressed file (LASzip specification).
struct LazLayout {
  enum Compressor { Pointwise = 1, Chunked = 2, Layered = 3 };
  static constexpr std::uint32_t kVariable = 0xFFFFFFFF;  ///< as chunk size: the table counts each chunk's points

  int compressor = 0;
  std::uint32_t chunkSize = 0;  ///< points; of Chunked and Layered
  std::vector<laz::Item> items;

  std::string describe() const;  ///< "LAZ in layers, chunks of 50000 points"
};

/// Points that stand together: a chunk of a LAZ file, a stretch of a LAS file.
struct LasRun {
  std::uint64_t offset = 0, bytes = 0;
  std::uint64_t count = 0;  ///< points
};

/// Reads the record's payload. Error where it is none or of a kind that is not known.
Result<LazLayout> parseLazRecord(std::span<const std::byte> payload, const std::string& path);
/// The payload that says so, for files that are written.
std::vector<std::byte> makeLazRecord(const LazLayout& layout);

/// The chunks in file order, from the chunk table. Nothing where the file has none or an empty one: the chunks
/// must then be decoded one after the other. Error where the table cannot be true.
Result<std::optional<std::vector<LasRun>>> readChunkTable(const ByteSource& file, const LasHeader& header);
/// The table's bytes: to stand behind the points, its place at the points' offset.
std::vector<std::byte> makeChunkTable(const std::vector<LasRun>& chunks, bool variable);

}  // namespace alidade
