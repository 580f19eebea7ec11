// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace alidade::laz {

/// One part of a point record and how it is coded (LASzip specification, table of item types).
struct Item {
  enum Type { Byte = 0, Point10 = 6, GpsTime11 = 7, Rgb12 = 8, WavePacket13 = 9, Point14 = 10, Rgb14 = 11,
              RgbNir14 = 12, WavePacket14 = 13, Byte14 = 14 };
  int type = 0;
  std::size_t size = 0;  ///< bytes of the record
  int version = 0;
};

/// The parts of a LAS point record of this format and length; layered (version 3) from format 6 on.
std::vector<Item> itemsOf(int pointFormat, std::size_t recordLength);

/// Empty where these items make up records of `recordLength` bytes of this format and are all known;
/// else what is wrong with them.
std::string whyNotDecodable(const std::vector<Item>& items, int pointFormat, std::size_t recordLength);

/// Decodes a chunk's points one run after another. Reusable for further chunks. Never fails on damaged bytes:
/// the points are then nonsense, and `overran` tells in most cases.
class ChunkDecoder {
 public:
  static std::unique_ptr<ChunkDecoder> make(const std::vector<Item>& items);
  virtual ~ChunkDecoder() = default;

  /// Bytes behind a chunk that must be readable.
  static constexpr std::size_t kReadable = 1 << 14;

  /// False where the bytes cannot hold a chunk. They must live, and kReadable bytes behind them, until the next start.
  virtual bool start(std::span<const std::byte> chunk) = 0;
  /// The next `count` records into `out`.
  virtual void decode(std::size_t count, std::byte* out) = 0;
  /// The same for two chunks side by side, which hides most of the time that one waits for its last symbol.
  /// `other` was made of the same items.
  virtual void decodeBoth(ChunkDecoder& other, std::size_t count, std::byte* out, std::byte* otherOut) = 0;
  /// Points have been taken from behind the chunk's end.
  virtual bool overran() const = 0;
  /// How many bytes of the chunk have been taken, when all of its points have.
  virtual std::size_t taken() const = 0;
  /// How many points the chunk itself says it has; 0 where it does not.
  virtual std::uint32_t statedCount() const { return 0; }
};

/// Encodes `count` records (at least one) as one chunk of version 2 (formats 0-5) or 3 (6-10).
std::vector<std::byte> encodeChunk(const std::vector<Item>& items, const std::byte* records, std::size_t count);

}  // namespace alidade::laz
