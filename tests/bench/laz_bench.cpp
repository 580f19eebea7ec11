// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// LAZ decoding, point format 3, from memory into point records.

#include <cmath>
#include <filesystem>
#include <random>

#include <benchmark/benchmark.h>

#include "base/parallel.h"
#include "las/las_reader.h"
#include "las/las_runs.h"
#include "las/laz_chunk.h"

namespace {

using namespace alidade;

constexpr std::size_t kRecord = 34, kChunk = 50000, kChunks = 40;

struct Chunk {
  std::vector<std::byte> bytes;  ///< and laz::ChunkDecoder::kReadable behind them
  std::size_t size = 0, count = 0;
};

/// Format 3 records as a scanner brings them: columns of shots on a ground, a facade and a few poles, 2 mm of noise in
/// steps of 1 mm, intensity that falls with the distance, steady times, colours of a picture.
std::vector<std::byte> scanRecords(std::size_t count) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 0.002);
  std::vector<std::byte> records(count * kRecord);
  for (std::size_t i = 0; i < count; ++i) {
    const double azimuth = static_cast<double>(i / 1500) * 0.002, elevation = -0.9 + 0.001 * static_cast<double>(i % 1500);
    double range = elevation < -0.05 ? 1.8 / std::sin(-elevation) : 20.0 / std::max(0.3, std::abs(std::cos(azimuth)));
    range = std::min({range, 20.0 / std::max(0.3, std::abs(std::cos(azimuth))), std::fmod(azimuth, 0.5) < 0.01 ? 8.0 : 99.0});
    range += noise(random);
    const double level = range * std::cos(elevation);
    const auto millimetres = [](double v) { return static_cast<std::int32_t>(std::lround(v * 1000)); };
    std::byte* at = records.data() + i * kRecord;
    const auto put = [&](std::size_t field, auto value) { std::memcpy(at + field, &value, sizeof value); };
    put(0, millimetres(level * std::cos(azimuth)));
    put(4, millimetres(level * std::sin(azimuth)));
    put(8, millimetres(range * std::sin(elevation)));
    const double shade = 0.5 + 0.5 * std::sin(level * 3 + azimuth * 5);
    put(12, static_cast<std::uint16_t>(3000 / (1 + range / 10) + 40 * shade + static_cast<double>(random() % 32)));
    at[14] = std::byte{0x09};  // return 1 of 1
    at[15] = static_cast<std::byte>(range > 19 ? 6 : 2);
    put(18, std::uint16_t{1});
    put(20, 1000.0 + 1e-5 * static_cast<double>(i));
    for (std::size_t c = 0; c < 3; ++c)
      put(28 + 2 * c, static_cast<std::uint16_t>(257 * static_cast<unsigned>(60 + 50 * shade + 10 * static_cast<double>(c) +
                                                                             static_cast<double>(random() % 6))));
  }
  return records;
}

const std::vector<Chunk>& scanChunks() {
  static const std::vector<Chunk> chunks = [] {
    const auto records = scanRecords(kChunk * kChunks);
    std::vector<Chunk> made(kChunks);
    for (std::size_t i = 0; i < kChunks; ++i) {
      made[i].bytes = laz::encodeChunk(laz::itemsOf(3, kRecord), records.data() + i * kChunk * kRecord, kChunk);
      made[i].size = made[i].bytes.size();
      made[i].count = kChunk;
      made[i].bytes.resize(made[i].size + laz::ChunkDecoder::kReadable);
    }
    return made;
  }();
  return chunks;
}

/// Two chunks side by side, as the reader does.
class PairDecoder {
 public:
  PairDecoder() : m_first(laz::ChunkDecoder::make(laz::itemsOf(3, kRecord))), m_second(laz::ChunkDecoder::make(laz::itemsOf(3, kRecord))) {}

  void decode(const Chunk& a, const Chunk& b) {
    m_out.resize((a.count + b.count) * kRecord);
    std::byte* out = m_out.data() + a.count * kRecord;
    m_first->start(std::span(a.bytes).first(a.size));
    m_second->start(std::span(b.bytes).first(b.size));
    m_first->decodeBoth(*m_second, std::min(a.count, b.count), m_out.data(), out);
    benchmark::DoNotOptimize(m_out.data());
  }

 private:
  std::unique_ptr<laz::ChunkDecoder> m_first, m_second;
  std::vector<std::byte> m_out;
};

void laz_decode_fmt3_1core(benchmark::State& state) {
  const auto& chunks = scanChunks();
  PairDecoder decoder;
  for (auto _ : state)
    for (std::size_t i = 0; i + 1 < chunks.size(); i += 2) decoder.decode(chunks[i], chunks[i + 1]);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kChunk * kChunks));
}
BENCHMARK(laz_decode_fmt3_1core)->Unit(benchmark::kMillisecond);

void laz_decode_fmt3_2cores(benchmark::State& state) {
  const auto& chunks = scanChunks();
  std::vector<PairDecoder> decoders(workerCount());
  for (auto _ : state)
    parallelFor(chunks.size() / 2, 1, [&](std::size_t first, std::size_t last, int worker) {
      for (std::size_t i = first; i < last; ++i) decoders[worker].decode(chunks[2 * i], chunks[2 * i + 1]);
    });
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kChunk * kChunks));
  state.counters["cores"] = workerCount();
}
BENCHMARK(laz_decode_fmt3_2cores)->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();

/// The whole reader, to columns, on a LAZ file of another program.
void laz_read_ellipsoid(benchmark::State& state) {
  const std::string path = ALIDADE_SHARED_DATA_DIR "/copc/ellipsoid.laz";
  if (!std::filesystem::exists(path)) return state.SkipWithError("no shared data");
  std::int64_t count = 0;
  for (auto _ : state)
    (void)LasReader().read(path, [&](PointBatch& batch) { count += static_cast<std::int64_t>(batch.size()); return true; }, Progress());
  state.SetItemsProcessed(count);
}
BENCHMARK(laz_read_ellipsoid)->Unit(benchmark::kMillisecond)->UseRealTime();

/// A LAS file, to columns.
void las_read_fmt2(benchmark::State& state) {
  const std::string path = ALIDADE_SHARED_DATA_DIR "/indoor_video/cloud_quarter.las";
  if (!std::filesystem::exists(path)) return state.SkipWithError("no shared data");
  std::int64_t count = 0;
  for (auto _ : state)
    (void)LasReader().read(path, [&](PointBatch& batch) { count += static_cast<std::int64_t>(batch.size()); return true; }, Progress());
  state.SetItemsProcessed(count);
}
BENCHMARK(las_read_fmt2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
