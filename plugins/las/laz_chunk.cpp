// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/laz_chunk.h"

#include <fmt/format.h>

#include "las/laz_chunk_body.h"
#include "las/laz_chunk_sets.h"

namespace alidade::laz {

namespace {

/// More extra bytes than this are no scan; it bounds what a lying record length makes us allocate.
constexpr std::size_t kMostExtraBytes = 4096;

std::vector<std::byte> encodeLayered(const std::vector<Item>& items, const std::byte* records, std::size_t count) {
  LayeredItems<Encoder> coded(items);
  const std::size_t record = coded.recordSize();
  coded.start(records);
  std::vector<std::byte> scratch(record);
  for (std::size_t i = 1; i < count; ++i) {
    std::memcpy(scratch.data(), records + i * record, record);
    coded.code(scratch.data());
  }
  std::vector<std::byte> out(records, records + record);
  const auto put = [&](std::uint32_t number) {
    out.resize(out.size() + 4);
    store(out.data() + out.size() - 4, number);
  };
  put(static_cast<std::uint32_t>(count));
  std::vector<std::vector<std::byte>> streams;
  for (std::size_t i = 0; i < coded.layers().size(); ++i) {
    auto& layer = coded.layers()[i];
    // Returns and x, y are always there.
    streams.push_back(layer.present || i == 0 ? layer.coder.finish() : std::vector<std::byte>());
    put(static_cast<std::uint32_t>(streams.back().size()));
  }
  for (const auto& stream : streams) out.insert(out.end(), stream.begin(), stream.end());
  return out;
}

std::vector<std::byte> encodePointwise(const std::vector<Item>& items, const std::byte* records, std::size_t count) {
  ItemsV2 coded(items);
  const std::size_t record = coded.recordSize();
  coded.start(records);
  Encoder coder;
  std::vector<std::byte> scratch(record);
  for (std::size_t i = 1; i < count; ++i) {
    std::byte* at = scratch.data();
    std::memcpy(at, records + i * record, record);
    coded.code(coder, at);
  }
  std::vector<std::byte> out(records, records + record);
  const auto stream = coder.finish();
  out.insert(out.end(), stream.begin(), stream.end());
  return out;
}

}  // namespace

std::vector<Item> itemsOf(int pointFormat, std::size_t recordLength) {
  std::vector<Item> items;
  const auto add = [&](int type, std::size_t size, int version) { items.push_back({type, size, version}); };
  if (pointFormat <= 5) {
    add(Item::Point10, 20, 2);
    if (pointFormat != 0 && pointFormat != 2) add(Item::GpsTime11, 8, 2);
    if (pointFormat == 2 || pointFormat == 3 || pointFormat == 5) add(Item::Rgb12, 6, 2);
    if (pointFormat >= 4) add(Item::WavePacket13, 29, 1);
  } else {
    add(Item::Point14, 30, 3);
    if (pointFormat == 7) add(Item::Rgb14, 6, 3);
    if (pointFormat == 8 || pointFormat == 10) add(Item::RgbNir14, 8, 3);
    if (pointFormat >= 9) add(Item::WavePacket14, 29, 3);
  }
  const std::size_t size = sizeOf(items);
  if (recordLength > size) add(pointFormat <= 5 ? Item::Byte : Item::Byte14, recordLength - size, pointFormat <= 5 ? 2 : 3);
  return items;
}

std::string whyNotDecodable(const std::vector<Item>& items, int pointFormat, std::size_t recordLength) {
  const std::vector<Item> expected = itemsOf(pointFormat, recordLength);
  if (items.size() != expected.size() || sizeOf(items) != recordLength)
    return fmt::format("its {} parts of together {} bytes are not those of point format {} in {} bytes", items.size(),
                       sizeOf(items), pointFormat, recordLength);
  const bool old = items.front().version == 1;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Item& item = items[i];
    if (item.type != expected[i].type || item.size != expected[i].size)
      return fmt::format("part {} is of type {} and {} bytes, where point format {} has type {} and {} bytes", i + 1,
                         item.type, item.size, pointFormat, expected[i].type, expected[i].size);
    const bool known = item.type == Item::WavePacket13 ? item.version == 1
                       : pointFormat >= 6              ? item.version == 3 || item.version == 4
                                                       : item.version == (old ? 1 : 2);
    if (!known) return fmt::format("part {} (type {}) is coded in the unknown version {}", i + 1, item.type, item.version);
  }
  if (extraBytes(items) > kMostExtraBytes)
    return fmt::format("a point has {} extra bytes, more than {}", extraBytes(items), kMostExtraBytes);
  return {};
}

std::vector<MakeDecoder> usableDecoders() {
  std::vector<MakeDecoder> decoders{makeDecoder};
#if defined(ALIDADE_LAZ_SETS)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2")) decoders.push_back(makeAvx2Decoder);
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("bmi2"))
    decoders.push_back(makeAvx512Decoder);
#endif
  return decoders;
}

std::unique_ptr<ChunkDecoder> ChunkDecoder::make(const std::vector<Item>& items) {
  static const MakeDecoder fastest = usableDecoders().back();
  return fastest(items);
}

std::vector<std::byte> encodeChunk(const std::vector<Item>& items, const std::byte* records, std::size_t count) {
  return items.front().type == Item::Point14 ? encodeLayered(items, records, count)
                                             : encodePointwise(items, records, count);
}

}  // namespace alidade::laz
