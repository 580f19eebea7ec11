// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/distribution.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <mutex>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <type_traits>
#include <unordered_map>

#include "base/widest.h"
#include "cloud/raw_bytes.h"
#include "cloud/record_packing.h"
#include "cloud/scan_reading.h"

namespace alidade {

namespace {

constexpr std::uint32_t kOtherStreams = 8;

/// Leaves out the points that cannot be used. Returns how many.
std::uint64_t dropUnusable(PointBatch& batch) {
  if (areUsablePositions(batch.position)) return 0;
  std::vector<std::uint32_t> good;
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (isUsablePosition(batch.position[i])) good.push_back(static_cast<std::uint32_t>(i));
  const std::size_t all = batch.size();
  const auto pick = [&](auto& column) {
    if (column.size() != all) return;
    for (std::size_t i = 0; i < good.size(); ++i) column[i] = column[good[i]];
    column.resize(good.size());
  };
  for (ExtraColumn& extra : batch.extra) {
    const std::size_t bytes = extra.bytesPerPoint();
    if (extra.data.size() != all * bytes) continue;
    for (std::size_t i = 0; i < good.size(); ++i)
      std::memmove(extra.data.data() + i * bytes, extra.data.data() + good[i] * bytes, bytes);
    extra.data.resize(good.size() * bytes);
  }
  pick(batch.rgb), pick(batch.intensity), pick(batch.classification), pick(batch.returnNumber), pick(batch.returnCount);
  pick(batch.gpsTime), pick(batch.normal), pick(batch.scanner), pick(batch.pointSource), pick(batch.row), pick(batch.column);
  pick(batch.position);
  return all - good.size();
}

/// Cells of tiles that the sample did not meet: made as they come, shared by all workers.
class OtherCells {
 public:
  OtherCells(std::uint32_t firstId, std::uint32_t firstStream) : m_firstId(firstId), m_firstStream(firstStream) {}

  std::uint32_t idOf(const glm::ivec3& tile) {
    std::lock_guard lock(m_mutex);
    const auto [at, isNew] = m_ids.try_emplace(tile, m_firstId + static_cast<std::uint32_t>(m_tiles.size()));
    if (isNew) m_tiles.push_back(tile);
    return at->second;
  }
  std::uint32_t streamOf(const glm::ivec3& tile) const {
    return m_firstStream + static_cast<std::uint32_t>(TileHash()(tile) >> 40) % kOtherStreams;
  }
  const std::vector<glm::ivec3>& tiles() const { return m_tiles; }

 private:
  std::uint32_t m_firstId, m_firstStream;
  std::mutex m_mutex;
  std::unordered_map<glm::ivec3, std::uint32_t, TileHash> m_ids;
  std::vector<glm::ivec3> m_tiles;
};

constexpr std::size_t kStretch = 256;

/// Some points: units from the lattice's corner, and colours as they are drawn.
struct Stretch {
  std::array<std::int64_t, kStretch> x, y, z;
  std::array<std::uint16_t, kStretch> colours;
};

/// The keys of the points' tiles (CellFinder), and their places in these with their colours, as in DisplayPoint.
ALIDADE_WIDEST void namePlaces(const Stretch& points, std::size_t count, std::uint64_t* __restrict tiles, std::uint64_t* __restrict places) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<std::uint64_t>(points.x[i]), y = static_cast<std::uint64_t>(points.y[i]),
               z = static_cast<std::uint64_t>(points.z[i]);
    tiles[i] = (x >> 16 & 0x1fffff) | (y >> 16 & 0x1fffff) << 21 | (z >> 16 & 0x1fffff) << 42;
    places[i] = (x & 0xffff) | (y & 0xffff) << 16 | (z & 0xffff) << 32 | static_cast<std::uint64_t>(points.colours[i]) << 48;
  }
}

class Worker {
 public:
  Worker(const ChunkPlan& plan, const Lattice& lattice, const PointSchema& schema, std::uint16_t brightest, OtherCells& others,
         RecordStreams& streams)
      : m_plan(plan), m_lattice(lattice), m_schema(schema), m_layout(lattice, schema), m_brightest(brightest), m_others(others),
        m_finder(plan), m_writer(streams, streamsFor(plan)) {}

  using Outcome = DistributionResult::Outcome;

  Outcome take(std::uint64_t number, PointBatch& batch) {
    m_dropped += dropUnusable(batch);
    const std::size_t count = batch.size();
    if (count == 0) return Outcome::Done;
    if (!m_schema.covers(batch)) return Outcome::NewColumns;
    if (!pack(batch)) return Outcome::OffLattice;
    send(number, count, [this](const std::uint32_t* rows, std::uint32_t some, std::byte* to) { copyRecords(rows, some, to); });
    return Outcome::Done;
  }

  /// Records whose scale and offset are the lattice's.
  Outcome take(std::uint64_t number, PointRecords records) {
    if (records.count == 0) return Outcome::Done;
    const RecordFormat& format = records.format;
    if (!m_packing) {
      if (!m_schema.covers(format)) return Outcome::NewColumns;
      if (format.scale != m_lattice.scale || format.offset != m_lattice.offset) return Outcome::OffLattice;
      m_packing.emplace(m_schema, format, m_layout.bytes - m_layout.columnsAt);
      for (const RecordField& field : format.fields) {
        if (!field.extra && field.name == "rgb") m_rgbAt = field.at;
        if (!field.extra && field.name == "intensity") m_intensityAt = field.at;
      }
    }
    keepUsable(records);
    const glm::i64vec3 low = glm::i64vec3(records.low) - m_lattice.corner, high = glm::i64vec3(records.high) - m_lattice.corner;
    if (records.count == 0) return Outcome::Done;
    if (!m_lattice.counts(low) || !m_lattice.counts(high)) return Outcome::OffLattice;
    locate(records);
    send(number, records.count, [&](const std::uint32_t* rows, std::uint32_t count, std::byte* to) {
      for (std::uint32_t i = 0; i < count; ++i) std::memcpy(to + i * m_layout.bytes, &m_places[rows[i]], sizeof m_places[0]);
      m_packing->pack(records.data, rows, count, to + m_layout.columnsAt, m_layout.bytes);
    });
    return Outcome::Done;
  }

  RecordStreams::Writer& writer() { return m_writer; }
  const std::vector<std::uint64_t>& counts() const { return m_counts; }
  std::uint64_t dropped() const { return m_dropped; }

 private:
  /// The batch as records, and the cell of each; false where a point does not fit the lattice.
  bool pack(const PointBatch& batch) {
    const std::size_t count = batch.size(), stride = m_layout.bytes;
    m_records.resize(count * stride);
    m_places.resize(count), m_cells.resize(count);
    const PointSchema::Packing packing(m_schema, batch);
    std::array<glm::i64vec3, kStretch> units;
    // A stretch after the other: what one column leaves is at hand for the next.
    for (std::size_t first = 0; first < count; first += kStretch) {
      const std::size_t some = std::min(kStretch, count - first);
      std::byte* out = m_records.data() + first * stride;
      if (!m_lattice.unitsOf(std::span(batch.position).subspan(first, some), units.data(), nullptr)) return false;
      for (std::size_t i = 0; i < some; ++i) m_stretch.x[i] = units[i].x, m_stretch.y[i] = units[i].y, m_stretch.z[i] = units[i].z;
      const auto part = [&](const auto& column) {
        using Column = std::span<const typename std::decay_t<decltype(column)>::value_type>;
        return column.size() == count ? Column(column).subspan(first, some) : Column();
      };
      displayColours(part(batch.rgb), batch.rgbWhite, part(batch.intensity), m_brightest, some, m_stretch.colours.data());
      locate(first, some);
      for (std::size_t i = 0; i < some; ++i) std::memcpy(out + i * stride, &m_places[first + i], sizeof m_places[0]);
      if (m_lattice.exactBytes() > 0)
        for (std::size_t i = 0; i < some; ++i)
          if (!m_lattice.packExact(batch.position[first + i], out + i * stride + m_layout.exactAt)) return false;
      packing.pack(first, some, out + m_layout.columnsAt, stride, stride - m_layout.columnsAt);
    }
    return true;
  }

  /// What a record begins with, and the cell, of the stretch's points, which are the batch's from `first` on.
  void locate(std::size_t first, std::size_t count) {
    std::array<std::uint64_t, kStretch> tiles;
    namePlaces(m_stretch, count, tiles.data(), m_places.data() + first);
    std::uint32_t* cells = m_cells.data() + first;
    m_finder.find(tiles.data(), m_places.data() + first, count, cells);
    for (std::size_t i = 0; i < count; ++i)
      if (cells[i] == ChunkPlan::kNone) cells[i] = otherCell(CellFinder::tileOfKey(tiles[i]));
  }

  static glm::ivec3 numbersOf(const std::byte* record) {
    glm::ivec3 numbers;
    std::memcpy(&numbers, record, sizeof numbers);
    return numbers;
  }

  /// Leaves out the records that cannot be used.
  void keepUsable(PointRecords& records) {
    const auto usable = [&](const glm::ivec3& numbers) {
      return isUsablePosition(records.format.scale * glm::dvec3(numbers) + records.format.offset);
    };
    if (usable(records.low) && usable(records.high)) return;
    const std::size_t bytes = records.format.bytes, all = records.count;
    m_usable.clear();
    records.low = glm::ivec3(std::numeric_limits<std::int32_t>::max()), records.high = -records.low;
    for (std::size_t i = 0; i < all; ++i) {
      const std::byte* record = records.data + i * bytes;
      const glm::ivec3 numbers = numbersOf(record);
      if (!usable(numbers)) continue;
      records.low = glm::min(records.low, numbers), records.high = glm::max(records.high, numbers);
      m_usable.insert(m_usable.end(), record, record + bytes);
    }
    records.data = m_usable.data(), records.count = m_usable.size() / bytes;
    m_dropped += all - records.count;
  }

  void locate(const PointRecords& records) {
    const std::size_t bytes = records.format.bytes;
    m_places.resize(records.count), m_cells.resize(records.count);
    std::array<std::uint16_t, kStretch> intensities;
    for (std::size_t first = 0; first < records.count; first += kStretch) {
      const std::size_t some = std::min(kStretch, records.count - first);
      const std::byte* from = records.data + first * bytes;
      std::uint16_t* colours = m_stretch.colours.data();
      if (m_rgbAt) {
        rgb565Of(from + *m_rgbAt, bytes, records.format.rgbWhite, some, colours);
      } else {
        for (std::size_t i = 0; m_intensityAt && i < some; ++i) std::memcpy(&intensities[i], from + i * bytes + *m_intensityAt, sizeof intensities[i]);
        displayColours({}, 0, std::span<const std::uint16_t>(intensities).first(m_intensityAt ? some : 0), m_brightest, some, colours);
      }
      for (std::size_t i = 0; i < some; ++i) {
        const glm::ivec3 numbers = numbersOf(from + i * bytes);
        m_stretch.x[i] = numbers.x - m_lattice.corner.x, m_stretch.y[i] = numbers.y - m_lattice.corner.y,
        m_stretch.z[i] = numbers.z - m_lattice.corner.z;
      }
      locate(first, some);
    }
  }

  std::uint32_t otherCell(const glm::ivec3& tile) {
    const auto found = m_otherIds.find(tile);
    if (found != m_otherIds.end()) return found->second;
    const std::uint32_t id = m_others.idOf(tile);
    m_otherIds.emplace(tile, id);
    m_otherStreams[id] = m_others.streamOf(tile);
    return id;
  }

  std::uint32_t streamOf(std::uint32_t cell) const {
    return cell < m_plan.cells().size() ? m_plan.streamOf(cell) : m_otherStreams.at(cell);
  }

  /// The records of these points, one after the other.
  void copyRecords(const std::uint32_t* rows, std::uint32_t count, std::byte* to) const {
    const std::byte* records = m_records.data();
    const auto copy = [&](auto stride) {
      for (std::uint32_t i = 0; i < count; ++i) std::memcpy(to + i * std::size_t{stride}, records + rows[i] * std::size_t{stride}, stride);
    };
    switch (m_layout.bytes) {
      case 8: return copy(std::integral_constant<std::size_t, 8>{});
      case 16: return copy(std::integral_constant<std::size_t, 16>{});
      case 24: return copy(std::integral_constant<std::size_t, 24>{});
      case 32: return copy(std::integral_constant<std::size_t, 32>{});
      default: return copy(m_layout.bytes);
    }
  }

  /// Records to their streams, a run a cell, in the batch's order inside it; `write` puts those of some rows there.
  template <class Write>
  void send(std::uint64_t number, std::size_t count, const Write& write) {
    const std::uint32_t most = *std::max_element(m_cells.begin(), m_cells.begin() + static_cast<std::ptrdiff_t>(count));
    if (m_inBatch.size() <= most) m_inBatch.resize(most + 1), m_counts.resize(most + 1);
    m_met.clear();
    for (std::size_t i = 0; i < count; ++i)
      if (m_inBatch[m_cells[i]]++ == 0) m_met.push_back(m_cells[i]);
    m_sorted.resize(count);
    m_next.resize(m_inBatch.size());
    std::uint32_t sum = 0;
    for (const std::uint32_t cell : m_met) m_next[cell] = sum, sum += m_inBatch[cell];
    for (std::size_t i = 0; i < count; ++i) m_sorted[m_next[m_cells[i]]++] = static_cast<std::uint32_t>(i);
    const std::uint32_t* row = m_sorted.data();
    for (const std::uint32_t cell : m_met) {
      m_counts[cell] += m_inBatch[cell];
      while (m_inBatch[cell] > 0) {
        std::uint32_t fits = 0;
        std::byte* to = m_writer.beginRun(streamOf(cell), {cell, m_inBatch[cell], number}, &fits);
        m_inBatch[cell] -= fits;
        write(row, fits, to);
        row += fits;
      }
    }
  }

  const ChunkPlan& m_plan;
  const Lattice& m_lattice;
  const PointSchema& m_schema;
  RecordLayout m_layout;
  std::uint16_t m_brightest;
  OtherCells& m_others;
  CellFinder m_finder;
  RecordStreams::Writer m_writer;
  std::optional<RecordPacking> m_packing;
  std::optional<std::size_t> m_rgbAt, m_intensityAt;  ///< in the source's records
  Stretch m_stretch;
  RawVector<std::uint64_t> m_places;  ///< of the batch: what a record begins with
  RawVector<std::byte> m_records;
  std::vector<std::byte> m_usable;
  std::vector<std::uint32_t> m_cells;
  std::vector<std::uint32_t> m_inBatch, m_next, m_met, m_sorted;  ///< by cell, by cell, cells, points
  std::vector<std::uint64_t> m_counts;
  std::unordered_map<glm::ivec3, std::uint32_t, TileHash> m_otherIds;
  std::unordered_map<std::uint32_t, std::uint32_t> m_otherStreams;
  std::uint64_t m_dropped = 0;
};

}  // namespace

std::uint32_t streamsFor(const ChunkPlan& plan) {
  return plan.streamCount() + kOtherStreams;
}

Result<DistributionResult> distribute(const ScanSource& source, const ChunkPlan& plan, const Lattice& lattice,
                                      const PointSchema& schema, const DistributionOptions& options,
                                      RecordStreams& streams, const Progress& progress) {
  DistributionResult result;
  result.schema = schema;
  OtherCells others(static_cast<std::uint32_t>(plan.cells().size()), plan.streamCount());
  std::mutex mutex;
  std::vector<std::unique_ptr<Worker>> workers;
  bool outOfMemory = false;
  for (int t = 0; t < options.threads; ++t)
    workers.push_back(std::make_unique<Worker>(plan, lattice, schema, options.brightestIntensity, others, streams));
  const auto takeRun = [&](std::uint64_t number, auto& points, const auto& shape, int worker) {
    try {
      const auto outcome = workers[static_cast<std::size_t>(worker)]->take(number, points);
      if (outcome == DistributionResult::Outcome::Done) return true;
      std::lock_guard lock(mutex);
      result.outcome = outcome;
      if (outcome == DistributionResult::Outcome::NewColumns) result.schema.include(shape);
    } catch (const std::bad_alloc&) {
      std::lock_guard lock(mutex);
      outOfMemory = true;
    }
    return false;
  };
  const auto take = [&](std::uint64_t number, PointBatch& batch, int worker) { return takeRun(number, batch, batch, worker); };
  TakeRecords takeRecords;
  if (lattice.exact == ExactCoordinates::Lattice)
    takeRecords = [&](std::uint64_t number, const PointRecords& records, int worker) {
      return takeRun(number, records, records.format, worker);
    };
  const auto read = readOnThreads(source, options.threads, take, takeRecords, progress);
  Result<void> written;
  for (auto& worker : workers) {
    if (auto done = worker->writer().finish(); !done && written) written = done;
    streams.adopt(worker->writer());
    result.dropped += worker->dropped();
  }
  if (outOfMemory) return fail("There is not enough memory to index the scan", source.name, "Close other programs or allow less memory");
  if (!written) return fail(written.error());
  if (progress.cancelled()) return fail(cancelledError());
  if (result.outcome != DistributionResult::Outcome::Done) return result;
  if (!read) return fail(read.error());

  const std::size_t cellCount = plan.cells().size() + others.tiles().size();
  for (std::uint32_t c = 0; c < cellCount; ++c) {
    const bool planned = c < plan.cells().size();
    FilledCell filled;
    filled.id = c;
    filled.cell = planned ? plan.cells()[c] : PlanCell{others.tiles()[c - plan.cells().size()], 0, {}};
    filled.stream = planned ? plan.streamOf(c) : others.streamOf(filled.cell.tile);
    for (const auto& worker : workers) filled.count += c < worker->counts().size() ? worker->counts()[c] : 0;
    if (filled.count > 0) result.cells.push_back(filled);
  }
  std::sort(result.cells.begin(), result.cells.end(),
            [](const FilledCell& a, const FilledCell& b) { return mortonLess(a.cell, b.cell); });
  result.streamCount = streamsFor(plan);
  return result;
}

}  // namespace alidade
