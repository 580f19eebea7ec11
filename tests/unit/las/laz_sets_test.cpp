// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// The decoders of all instruction sets, alone and two by two, on the chunks of other programs and on records of noise.

#include <filesystem>
#include <random>

#include <gmock/gmock.h>

#include "las/las_runs.h"
#include "las/laz_chunk_sets.h"

namespace fs = std::filesystem;
using namespace alidade;

namespace {

const fs::path kData(ALIDADE_SHARED_DATA_DIR);

#define NEED_SHARED_DATA() \
  if (!fs::exists(kData / "las")) GTEST_SKIP() << "SKIPPED: no real data at " << kData

using Bytes = std::vector<std::byte>;

struct Chunk {
  Bytes bytes;  ///< with what a decoder may read behind them
  std::size_t size = 0;
  Bytes records;  ///< that it shall be decoded to
};

/// Every chunk beside the next: through all decoders, in pieces of uneven length, alone and both.
void expectDecoded(const std::vector<laz::Item>& items, const std::vector<Chunk>& chunks, std::size_t length, const std::string& what) {
  int set = 0;
  for (const laz::MakeDecoder make : laz::usableDecoders()) {
    const auto a = make(items), b = make(items);
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const Chunk &first = chunks[i], &second = chunks[(i + 1) % chunks.size()];
      const std::size_t count = first.records.size() / length, otherCount = second.records.size() / length;
      const std::size_t both = std::min(count, otherCount), some = both / 3;
      Bytes one(first.records.size()), other(second.records.size());
      ASSERT_TRUE(a->start(std::span(first.bytes).first(first.size)));
      ASSERT_TRUE(b->start(std::span(second.bytes).first(second.size)));
      a->decodeBoth(*b, some, one.data(), other.data());
      a->decodeBoth(*b, both - some, one.data() + some * length, other.data() + some * length);
      a->decode(count - both, one.data() + both * length);
      b->decode(otherCount - both, other.data() + both * length);
      EXPECT_TRUE(one == first.records && other == second.records) << what << ", set " << set << ", chunks from " << i;
      EXPECT_FALSE(a->overran() || b->overran()) << what << ", set " << set;
      EXPECT_EQ(a->taken(), first.size) << what << ", set " << set;

      ASSERT_TRUE(a->start(std::span(first.bytes).first(first.size)));
      one.assign(one.size(), std::byte{});
      a->decode(some, one.data());
      a->decode(count - some, one.data() + some * length);
      EXPECT_EQ(one, first.records) << what << ", set " << set << ", alone, chunk " << i;
    }
    ++set;
  }
}

/// Records in which some fields stand still, some creep and some are noise, so that every branch of the coder has its turn.
Bytes noisyRecords(std::size_t count, std::size_t length, unsigned seed) {
  std::mt19937 random(seed);
  Bytes records(count * length);
  std::vector<unsigned> liveliness(length);  // in how many of 8 points a byte changes
  for (auto& each : liveliness) each = random() % 9;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t byte = 0; byte < length; ++byte) {
      const unsigned before = i == 0 ? 0 : std::to_integer<unsigned>(records[(i - 1) * length + byte]);
      const bool changes = random() % 8 < liveliness[byte];
      const unsigned now = !changes ? before : random() % 3 == 0 ? random() % 256 : before + 1;
      records[i * length + byte] = static_cast<std::byte>(now & 255);
    }
  return records;
}

}  // namespace

TEST(LazSets, EverySetDecodesTheChunksOfOtherProgramsBitForBit) {
  NEED_SHARED_DATA();
  const std::vector<std::pair<const char*, const char*>> pairs = {
      {"las/las-rs/point10.laz", "las/las-rs/point10.las"},       {"las/las-rs/point-time.laz", "las/las-rs/point-time.las"},
      {"las/las-rs/point-color.laz", "las/las-rs/point-color.las"}, {"las/las-rs/point-time-color.laz", "las/las-rs/point-time-color.las"},
      {"las/las-rs/extra-bytes.laz", "las/las-rs/extra-bytes.las"}, {"las/laspy/simple.laz", "las/laspy/simple.las"}};
  for (const auto& [laz, las] : pairs) {
    const auto packed = ByteSource::open((kData / laz).string()), plain = ByteSource::open((kData / las).string());
    const auto header = readLasHeader(**packed), plainHeader = readLasHeader(**plain);
    ASSERT_TRUE(header && plainHeader) << laz;
    const auto runs = runsOf(**packed, *header);
    ASSERT_TRUE(runs && *runs) << laz;
    std::vector<Chunk> chunks;
    std::uint64_t at = plainHeader->pointsOffset;
    for (const LasRun& run : **runs) {
      Chunk chunk{Bytes(run.bytes + laz::ChunkDecoder::kReadable), run.bytes, Bytes(run.count * header->recordLength)};
      ASSERT_TRUE((*packed)->readAt(run.offset, std::span(chunk.bytes).first(run.bytes)).has_value());
      ASSERT_TRUE((*plain)->readAt(at, chunk.records).has_value());
      at += chunk.records.size();
      chunks.push_back(std::move(chunk));
    }
    expectDecoded(header->laz->items, chunks, header->recordLength, laz);
  }
}

TEST(LazSets, EverySetDecodesEveryFormatAsItWasEncoded) {
  for (int format = 0; format <= 10; ++format)
    for (const std::size_t extra : {0u, 3u}) {
      const auto plain = laz::itemsOf(format, 0);
      std::size_t length = extra;
      for (const laz::Item& item : plain) length += item.size;
      const auto items = laz::itemsOf(format, length);
      std::vector<Chunk> chunks;
      for (unsigned i = 0; i < 4; ++i) {
        Chunk chunk;
        chunk.records = noisyRecords(1 + 700 * i, length, 100 * static_cast<unsigned>(format) + i);
        chunk.bytes = laz::encodeChunk(items, chunk.records.data(), chunk.records.size() / length);
        chunk.size = chunk.bytes.size();
        chunk.bytes.resize(chunk.size + laz::ChunkDecoder::kReadable);
        chunks.push_back(std::move(chunk));
      }
      expectDecoded(items, chunks, length, "format " + std::to_string(format));
    }
}
