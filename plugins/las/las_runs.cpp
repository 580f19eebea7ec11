// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_runs.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "base/parallel.h"

namespace alidade {

namespace {

/// Records and what becomes of them are to stay in a core's own cache.
constexpr std::uint64_t kBatchPoints = 1 << 14;
/// Points that one thread reads at a time: between two such groups of tasks others may have the cores.
constexpr std::uint64_t kGroupPoints = 1 << 18;
/// A chunk whose records take more than this is decoded piece by piece.
constexpr std::uint64_t kLargestRecords = 16 << 20;
constexpr std::uint64_t kMostPointsPerByte = 2048;

constexpr const char* kExportAgain = "The file is truncated or damaged: copy or export it again";

tl::unexpected<Error> brokenChunk(const ByteSource& file, const LasRun& run) {
  return fail(fmt::format("The {} points of a chunk end before they are complete", run.count),
              fmt::format("{}, chunk at byte {}", file.path(), run.offset), kExportAgain);
}

/// How many of `count` points go into each batch.
std::uint64_t evenBatch(std::uint64_t count) {
  const std::uint64_t batches = (count + kBatchPoints - 1) / kBatchPoints;
  return batches == 0 ? 1 : (count + batches - 1) / batches;
}

/// What one thread needs to turn runs into records.
class RunReader {
 public:
  RunReader(const ByteSource& file, const LasHeader& header) : m_file(file), m_header(header) {
    if (!header.laz) return;
    m_decoder = laz::ChunkDecoder::make(header.laz->items);
    m_second = laz::ChunkDecoder::make(header.laz->items);
  }

  /// Appends the runs' records.
  Result<void> read(std::span<const LasRun> runs, std::vector<std::byte>& records) {
    std::uint64_t count = 0;
    for (const LasRun& run : runs) count += run.count;
    const std::size_t length = m_header.recordLength;
    records.resize(count * length);
    std::byte* out = records.data();
    if (!m_header.laz) {
      for (const LasRun& run : runs) {
        if (auto ok = m_file.readAt(run.offset, std::span(out, run.count * length)); !ok) return ok;
        out += run.count * length;
      }
      return {};
    }
    for (std::size_t i = 0; i < runs.size(); i += 2) {
      const bool pair = i + 1 < runs.size();
      if (auto ok = start(*m_decoder, runs[i], m_bytes); !ok) return ok;
      if (pair)
        if (auto ok = start(*m_second, runs[i + 1], m_secondBytes); !ok) return ok;
      const std::uint64_t first = runs[i].count, second = pair ? runs[i + 1].count : 0, both = std::min(first, second);
      std::byte* secondOut = out + first * length;
      if (both > 0) m_decoder->decodeBoth(*m_second, both, out, secondOut);
      m_decoder->decode(first - both, out + both * length);
      if (m_decoder->overran()) return brokenChunk(m_file, runs[i]);
      if (pair) {
        m_second->decode(second - both, secondOut + both * length);
        if (m_second->overran()) return brokenChunk(m_file, runs[i + 1]);
      }
      out = secondOut + second * length;
    }
    return {};
  }

  /// A chunk that is too large for one piece of memory: piece by piece to `take`, which may stop it.
  Result<bool> readInPieces(const LasRun& run, const std::function<bool(const std::byte* records, std::size_t count)>& take) {
    if (auto ok = start(*m_decoder, run, m_bytes); !ok) return fail(ok.error());
    std::vector<std::byte> records;
    for (std::uint64_t done = 0; done < run.count;) {
      const std::uint64_t count = std::min(kBatchPoints, run.count - done);
      records.resize(count * m_header.recordLength);
      m_decoder->decode(count, records.data());
      if (m_decoder->overran()) return brokenChunk(m_file, run);
      if (!take(records.data(), count)) return false;
      done += count;
    }
    return true;
  }

  laz::ChunkDecoder& decoder() { return *m_decoder; }

 private:
  Result<void> start(laz::ChunkDecoder& decoder, const LasRun& run, std::vector<std::byte>& bytes) {
    if (run.count / kMostPointsPerByte > run.bytes) return brokenChunk(m_file, run);
    bytes.resize(run.bytes + laz::ChunkDecoder::kReadable);
    const auto chunk = std::span(bytes).first(run.bytes);
    if (auto ok = m_file.readAt(run.offset, chunk); !ok) return ok;
    if (!decoder.start(chunk)) return brokenChunk(m_file, run);
    if (decoder.statedCount() > 0 && decoder.statedCount() < run.count)
      return fail(fmt::format("A chunk says it has {} points where the file counts {}", decoder.statedCount(), run.count),
                  fmt::format("{}, chunk at byte {}", m_file.path(), run.offset), kExportAgain);
    return {};
  }

  const ByteSource& m_file;
  const LasHeader& m_header;
  std::unique_ptr<laz::ChunkDecoder> m_decoder, m_second;
  std::vector<std::byte> m_bytes, m_secondBytes;
};

/// Consecutive runs that one thread reads at a time: some ten thousand points, and two chunks where
/// there are two, so that they can be decoded side by side.
std::vector<std::span<const LasRun>> tasksOf(const std::vector<LasRun>& runs, const LasHeader& header) {
  std::vector<std::span<const LasRun>> tasks;
  const std::uint64_t large = kLargestRecords / header.recordLength;
  const std::size_t least = header.laz ? 2 : 1;
  for (std::size_t first = 0; first < runs.size();) {
    std::size_t end = first;
    std::uint64_t points = 0;
    do {
      points += runs[end++].count;
    } while (end < runs.size() && points + runs[end].count <= large &&
             (end - first < least || points + runs[end].count <= kBatchPoints));
    tasks.emplace_back(runs.data() + first, end - first);
    first = end;
  }
  return tasks;
}

/// Runs on their way to records, group by group on all cores.
class RunReading {
 public:
  RunReading(const ByteSource& file, const LasHeader& header, const std::vector<LasRun>& runs)
      : m_header(header), m_tasks(tasksOf(runs, header)), m_records(static_cast<std::size_t>(workerCount())) {
    for (int i = 0; i < workerCount(); ++i) m_readers.push_back(std::make_unique<RunReader>(file, header));
    for (const LasRun& run : runs) m_total += run.count;
  }

  /// Nothing is left.
  bool done() const { return m_next == m_tasks.size(); }
  double fraction() const { return static_cast<double>(m_points) / static_cast<double>(std::max<std::uint64_t>(1, m_total)); }
  /// Of points that were read.
  std::uint64_t points() const { return m_points; }

  /// Whether what comes next is a chunk that is too large to be decoded at once, and that chunk read, piece by piece.
  bool nextIsLarge() const { return isLarge(m_tasks[m_next]); }
  Result<bool> readLarge(const std::function<bool(const std::byte* records, std::size_t count)>& take) {
    const LasRun& run = m_tasks[m_next++].front();
    auto more = m_readers[0]->readInPieces(run, take);
    m_points += run.count;
    return more;
  }

  /// The next tasks, whatever of them can be read: `take` as TakeRecords.
  template <class Take>
  Result<void> readGroup(const Take& take) {
    std::size_t end = m_next;
    std::uint64_t points = 0;
    std::vector<std::uint64_t> firsts;
    const std::uint64_t most = kGroupPoints * static_cast<std::uint64_t>(workerCount());
    while (end < m_tasks.size() && points < most && !isLarge(m_tasks[end])) {
      firsts.push_back(m_points + points);
      for (const LasRun& run : m_tasks[end]) points += run.count;
      ++end;
    }
    std::vector<std::optional<Error>> errors(end - m_next);
    parallelFor(end - m_next, 1, [&](std::size_t from, std::size_t to, int worker) {
      const auto at = static_cast<std::size_t>(worker);
      for (std::size_t i = from; i < to; ++i) {
        if (auto ok = m_readers[at]->read(m_tasks[m_next + i], m_records[at]); !ok) {
          errors[i] = ok.error();
          continue;
        }
        const std::uint64_t count = m_records[at].size() / m_header.recordLength, batch = evenBatch(count);
        for (std::uint64_t first = 0; first < count; first += batch)
          take(firsts[i] + first, m_records[at].data() + first * m_header.recordLength, std::min(batch, count - first), worker);
      }
    });
    m_next = end;
    m_points += points;
    for (const auto& error : errors)
      if (error) return fail(*error);
    return {};
  }

 private:
  bool isLarge(std::span<const LasRun> task) const {
    return m_header.laz && task.front().count * m_header.recordLength > kLargestRecords;
  }

  const LasHeader& m_header;
  const std::vector<std::span<const LasRun>> m_tasks;
  std::vector<std::unique_ptr<RunReader>> m_readers;
  std::vector<std::vector<std::byte>> m_records;
  std::size_t m_next = 0;
  std::uint64_t m_points = 0, m_total = 0;
};

}  // namespace

Result<std::optional<std::vector<LasRun>>> runsOf(const ByteSource& file, const LasHeader& header) {
  if (header.laz) return readChunkTable(file, header);
  std::vector<LasRun> runs;
  // Long records: fewer at a time, so that a task stays within some megabytes.
  const std::uint64_t most = std::clamp<std::uint64_t>(kLargestRecords / header.recordLength, 1, kBatchPoints);
  for (std::uint64_t first = 0; first < header.pointCount; first += most) {
    const std::uint64_t count = std::min(most, header.pointCount - first);
    runs.push_back({header.pointsOffset + first * header.recordLength, count * header.recordLength, count});
  }
  return std::optional(std::move(runs));
}

Result<void> readRuns(const ByteSource& file, const LasHeader& header, const std::vector<LasRun>& runs,
                      const MakeBatch& make, const Progress& progress, const std::string& what) {
  RunReading reading(file, header, runs);
  while (!reading.done()) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(reading.fraction(), what);
    if (reading.nextIsLarge()) {
      const auto more = reading.readLarge([&](const std::byte* records, std::size_t count) { return make(records, count)(); });
      if (!more) return fail(more.error());
      if (!*more) return {};
      continue;
    }
    std::map<std::uint64_t, std::function<bool()>> batches;  // by their first points
    std::mutex mutex;
    const auto keep = [&](std::uint64_t first, const std::byte* records, std::size_t count, int) {
      auto batch = make(records, count);
      std::lock_guard lock(mutex);
      batches.emplace(first, std::move(batch));
    };
    if (auto ok = reading.readGroup(keep); !ok) return ok;
    for (auto& [first, handOver] : batches) {
      if (progress.cancelled()) return fail(cancelledError());
      if (!handOver()) return {};
    }
  }
  progress.report(1.0, what);
  return {};
}

Result<void> readAnyOrder(const ByteSource& file, const LasHeader& header, const TakeRecords& take, const Progress& progress,
                          const std::string& what) {
  if (header.pointCount == 0) return {};
  const auto runs = runsOf(file, header);
  if (!runs) return fail(runs.error());
  std::uint64_t first = 0;
  const auto takeNext = [&](const std::byte* records, std::size_t count) {
    return take(std::exchange(first, first + count), records, count, 0);
  };
  if (!*runs) {
    const MakeBatch make = [&](const std::byte* records, std::size_t count) -> std::function<bool()> {
      return [more = takeNext(records, count)] { return more; };
    };
    return readWithoutTable(file, header, make, progress, what);
  }
  RunReading reading(file, header, **runs);
  std::atomic<bool> stopped{false};
  while (!reading.done() && !stopped) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(reading.fraction(), what);
    if (reading.nextIsLarge()) {
      first = reading.points();
      const auto more = reading.readLarge(takeNext);
      if (!more) return fail(more.error());
      stopped = !*more;
      continue;
    }
    const auto give = [&](std::uint64_t at, const std::byte* records, std::size_t count, int worker) {
      if (!stopped && !take(at, records, count, worker)) stopped = true;
    };
    if (auto ok = reading.readGroup(give); !ok) return ok;
  }
  progress.report(1.0, what);
  return {};
}

Result<void> readWithoutTable(const ByteSource& file, const LasHeader& header, const MakeBatch& make,
                              const Progress& progress, const std::string& what) {
  const bool whole = header.laz->compressor == LazLayout::Pointwise;
  const bool counted = header.laz->compressor == LazLayout::Layered;
  if (!whole && !counted && header.laz->chunkSize == LazLayout::kVariable)
    return fail("The chunk table is missing, and without it chunks of different sizes cannot be told apart", file.path(),
                "The file was not written to its end: export it again");
  const auto decoder = laz::ChunkDecoder::make(header.laz->items);
  const std::size_t length = header.recordLength;
  std::uint64_t at = header.pointsOffset + (whole ? 0 : 8), done = 0;
  std::vector<std::byte> bytes, records;
  while (done < header.pointCount) {
    if (at >= file.size()) return brokenChunk(file, {at, 0, header.pointCount - done});
    const std::uint64_t left = header.pointCount - done;
    LasRun run{at, file.size() - at, whole ? left : std::min<std::uint64_t>(left, header.laz->chunkSize)};
    // No point takes four times its bytes when compressed.
    if (!whole && !counted && run.count < run.bytes / (4 * length)) run.bytes = run.count * 4 * length + 4096;
    run.bytes = std::min(run.bytes, file.size() - at);
    bytes.resize(run.bytes + laz::ChunkDecoder::kReadable);
    const auto chunk = std::span(bytes).first(run.bytes);
    if (auto ok = file.readAt(at, chunk); !ok) return ok;
    if (!decoder->start(chunk)) return brokenChunk(file, run);
    if (counted) run.count = std::min<std::uint64_t>(left, decoder->statedCount());
    if (run.count == 0) return brokenChunk(file, {at, 0, left});
    for (std::uint64_t taken = 0; taken < run.count;) {
      if (progress.cancelled()) return fail(cancelledError());
      progress.report(static_cast<double>(done) / static_cast<double>(header.pointCount), what);
      const std::uint64_t count = std::min(kBatchPoints, run.count - taken);
      records.resize(count * length);
      decoder->decode(count, records.data());
      if (decoder->overran()) return brokenChunk(file, run);
      if (!make(records.data(), count)()) return {};
      taken += count;
      done += count;
    }
    // A chunk of one point has no stream behind it; its four bytes are there all the same.
    at += decoder->taken();
  }
  progress.report(1.0, what);
  return {};
}

Result<void> readAllPoints(const ByteSource& file, const LasHeader& header, const MakeBatch& make,
                           const Progress& progress, const std::string& what) {
  if (header.pointCount == 0) return {};
  const auto runs = runsOf(file, header);
  if (!runs) return fail(runs.error());
  return *runs ? readRuns(file, header, **runs, make, progress, what)
               : readWithoutTable(file, header, make, progress, what);
}

std::vector<LasRun> sampleOf(const std::vector<LasRun>& runs, const LasHeader& header, std::uint64_t wanted) {
  if (wanted >= header.pointCount || runs.empty()) return runs;
  const double share = static_cast<double>(wanted) / static_cast<double>(header.pointCount);
  std::vector<LasRun> some;
  if (!header.laz) {
    // Blocks of about a page of the disk: fewer bytes would cost as much to read.
    constexpr std::uint64_t kBlock = 128;
    const std::uint64_t blocks = std::max<std::uint64_t>(1, wanted / kBlock);
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const auto first = static_cast<std::uint64_t>(static_cast<double>(header.pointCount) / static_cast<double>(blocks) *
                                                    static_cast<double>(i));
      const std::uint64_t count = std::min({kBlock, wanted, header.pointCount - first});
      some.push_back({header.pointsOffset + first * header.recordLength, count * header.recordLength, count});
    }
    return some;
  }
  // A chunk can be decoded from its start only: the first points of each, or of every k-th chunk where that would be few.
  constexpr double kFewest = 2000;
  const double mean = static_cast<double>(header.pointCount) / static_cast<double>(runs.size());
  const double step = std::max(1.0, std::min(kFewest, mean) / (mean * share));
  for (double at = 0; at < static_cast<double>(runs.size()); at += step) {
    LasRun run = runs[static_cast<std::size_t>(at)];
    run.count = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(static_cast<double>(run.count) * share * step), 1,
                                          run.count);
    some.push_back(run);
  }
  return some;
}

}  // namespace alidade
