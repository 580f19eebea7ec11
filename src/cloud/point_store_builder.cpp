// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <mutex>
#include <new>

#include "base/parallel.h"
#include "cloud/point_store.h"
#include "cloud/store_data.h"

namespace alidade {

namespace {

/// A part's columns in memory.
struct MemoryColumns {
  std::vector<std::vector<std::byte>> columns;
};

class MemorySink : public PartSink {
 public:
  Result<void> begin(std::uint64_t pointCount, const Lattice& lattice, const PointSchema& schema, bool) override {
    m_columns->columns.resize(kFirstAttribute + schema.columns.size());
    m_columns->columns[kPoints].resize(pointCount * sizeof(DisplayPoint));
    m_columns->columns[kExact].resize(pointCount * lattice.exactBytes());
    for (std::size_t c = 0; c < schema.columns.size(); ++c)
      m_columns->columns[kFirstAttribute + c].resize(pointCount * schema.columns[c].bytes());
    return {};
  }
  Result<void> write(std::size_t column, std::uint64_t offset, std::span<const std::byte> bytes) override {
    std::vector<std::byte>& to = m_columns->columns[column];
    if (column == kTables || column == kTops) {
      std::lock_guard lock(m_mutex);
      if (to.size() < offset + bytes.size()) to.resize(offset + bytes.size());
      std::memcpy(to.data() + offset, bytes.data(), bytes.size());
    } else {
      std::memcpy(to.data() + offset, bytes.data(), bytes.size());
    }
    return {};
  }
  Result<void> read(std::size_t column, std::uint64_t offset, std::span<std::byte> into) override {
    std::lock_guard lock(m_mutex);
    if (!into.empty()) std::memcpy(into.data(), m_columns->columns[column].data() + offset, into.size());
    return {};
  }

  std::shared_ptr<const PointStore> finish(const PartTree& part) {
    PointStoreData data = storeDataOf(part);
    auto& columns = m_columns->columns;
    if (columns.empty()) columns.resize(kFirstAttribute);
    columns[kTops] = {};
    const auto spanOf = [&]<class T>(std::size_t column, T) {
      return std::span<const T>(reinterpret_cast<const T*>(columns[column].data()), columns[column].size() / sizeof(T));
    };
    data.points = spanOf(kPoints, DisplayPoint{});
    data.exact = columns[kExact];
    data.tables = spanOf(kTables, std::uint32_t{});
    for (std::size_t c = 0; c < part.schema.columns.size(); ++c) data.columns.push_back(columns[kFirstAttribute + c]);
    data.owner = m_columns;
    return std::make_shared<const PointStore>(std::move(data));
  }

 private:
  std::shared_ptr<MemoryColumns> m_columns = std::make_shared<MemoryColumns>();
  std::mutex m_mutex;
};

}  // namespace

struct PointStoreBuilder::Impl {
  Options options;
  std::vector<PointBatch> batches;
  std::uint64_t count = 0, dropped = 0;
  Bounds bounds;

  Result<std::shared_ptr<const PointStore>> build(const Progress& progress) {
    ScanSource source;
    source.name = "points in memory";
    source.info.pointCount = count;
    source.info.bounds = bounds;
    source.info.scale = options.scale;
    source.info.offset = options.offset;
    // A copy at a time: a source may be read again where its first points promised too much.
    source.read = [this](const ScanSource::Sink& sink, const Progress& reading) -> Result<void> {
      std::uint64_t done = 0;
      PointBatch batch;  // the sink leaves a used one: its memory is at hand
      for (const PointBatch& each : batches) {
        if (reading.cancelled()) return fail(cancelledError());
        batch = each;
        done += batch.size();
        if (!sink(batch)) break;
        reading.report(static_cast<double>(done) / static_cast<double>(std::max<std::uint64_t>(count, 1)), "Sorting points");
      }
      return {};
    };
    // Everything is at hand: no point is met that the choice of the lattice did not know.
    source.sample = [this](std::uint64_t wanted, const ScanSource::Sink& sink, const Progress&) -> Result<void> {
      const std::uint64_t step = std::max<std::uint64_t>(1, count / std::max<std::uint64_t>(wanted, 1));
      for (const PointBatch& each : batches) {
        PointBatch some = each.every(0, step);
        if (!sink(some)) break;
      }
      return {};
    };
    PartOptions part;
    part.tree.kind = options.levels;
    part.tree.seed = options.seed;
    part.tree.leafPoints = std::max(1u, options.leafPoints);
    part.dimensions = options.dimensions;
    part.threads = options.threads > 0 ? options.threads : workerCount();
    part.memoryBytes = std::numeric_limits<std::uint64_t>::max() / 4;
    part.cellPoints = cellPointsFor(count);
    MemorySink sink;
    auto tree = indexPart(source, part, sink, progress);
    if (!tree) return fail(tree.error());
    batches.clear();
    progress.report(1.0, "Points ready");
    return sink.finish(*tree);
  }
};

PointStoreBuilder::PointStoreBuilder() : PointStoreBuilder(Options{}) {}
PointStoreBuilder::PointStoreBuilder(const Options& options) : m_impl(std::make_unique<Impl>()) {
  m_impl->options = options;
}
PointStoreBuilder::~PointStoreBuilder() = default;

void PointStoreBuilder::add(const PointBatch& batch) {
  add(PointBatch(batch));
}

void PointStoreBuilder::add(PointBatch&& batch) {
  if (batch.size() == 0) return;
  for (const glm::dvec3& p : batch.position) {
    if (isUsablePosition(p)) m_impl->bounds.add(p);
    else ++m_impl->dropped;
  }
  m_impl->count += batch.size();
  m_impl->batches.push_back(std::move(batch));
}

std::uint64_t PointStoreBuilder::droppedCount() const {
  return m_impl->dropped;
}

Result<std::shared_ptr<const PointStore>> PointStoreBuilder::build(const Progress& progress) {
  try {
    if (progress.cancelled()) return fail(cancelledError());
    return m_impl->build(progress);
  } catch (const std::bad_alloc&) {
    return fail("There is not enough memory for the cloud's points", {},
                "Close other data or open a thinned version of the cloud");
  }
}

}  // namespace alidade
