// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "las/las_writer.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "base/parallel.h"
#include "las/las_output_file.h"
#include "las/las_schema.h"
#include "las/las_write_header.h"
#include "las/laz_layout.h"

namespace alidade {

namespace {

using Kind = LasFormatWriter::Kind;

constexpr std::uint32_t kChunkPoints = 50000;

/// Records that are to become one chunk, and the cell they stand for.
struct PendingChunk {
  std::optional<OctreeCell> cell;
  std::vector<std::byte> records;
  std::vector<std::byte> coded;
};

class LasSink : public ScanSink {
 public:
  LasSink(Kind kind, std::string path, ScanWriteOptions options, LasOutputFile file)
      : m_kind(kind), m_path(std::move(path)), m_options(std::move(options)), m_file(std::move(file)) {}

  Result<void> add(const PointBatch& batch, const std::optional<OctreeCell>& cell) override {
    if (!m_schema)
      if (auto ok = begin(batch); !ok) return ok;
    if (m_kind == Kind::Las) {
      m_records.clear();
      if (auto ok = m_schema->encode(batch, m_path, m_records, m_totals); !ok) return ok;
      return m_file.write(m_records);
    }
    return m_kind == Kind::Laz ? addToChunks(batch) : addToCell(batch, cell);
  }

  Result<void> finish() override {
    if (!m_schema)
      if (auto ok = begin(PointBatch{}); !ok) return ok;
    if (m_kind != Kind::Las) {
      if (auto ok = writeChunks(); !ok) return ok;
      if (auto ok = writeTable(); !ok) return ok;
    }
    if (m_kind == Kind::Copc)
      if (auto ok = prepareHierarchy(); !ok) return ok;
    const std::uint64_t extendedAt = m_file.position();
    if (auto ok = m_file.write(m_frame.extendedBytes()); !ok) return ok;
    if (auto ok = m_file.patch(0, m_frame.bytes(*m_schema, m_totals, extendedAt)); !ok) return ok;
    return m_file.commit();
  }

  std::vector<std::string> remarks() const override {
    std::vector<std::string> all = m_frame.remarks;
    if (!m_schema) return all;
    all.insert(all.end(), m_schema->remarks().begin(), m_schema->remarks().end());
    const glm::dvec3& scale = m_schema->scale();
    if (m_totals.rounding > 0)
      all.push_back(fmt::format("Coordinates are rounded to steps of {} m: by up to {:.1e} m", std::max({scale.x, scale.y, scale.z}), m_totals.rounding));
    return all;
  }

 private:
  Result<void> begin(const PointBatch& first) {
    auto schema = LasSchema::of(first, m_options.info, m_options.notes, m_kind == Kind::Copc, m_path);
    if (!schema) return fail(schema.error());
    m_schema = std::move(*schema);
    m_frame = LasFileFrame::of(*m_schema, m_options);
    if (m_kind != Kind::Las) {
      m_frame.compressed = true;
      m_layout.items = laz::itemsOf(m_schema->pointFormat(), m_schema->recordLength());
      m_layout.compressor = m_schema->pointFormat() >= 6 ? LazLayout::Layered : LazLayout::Chunked;
      m_layout.chunkSize = m_kind == Kind::Copc ? LazLayout::kVariable : kChunkPoints;
      m_frame.records.push_back({"laszip encoded", 22204, "LASzip items", makeLazRecord(m_layout)});
    }
    // COPC's record must be the first of all.
    if (m_kind == Kind::Copc)
      m_frame.records.insert(m_frame.records.begin(), {"copc", 1, "COPC info", CopcInfo().bytes()});
    auto head = m_frame.bytes(*m_schema, m_totals, 0);
    m_pointsAt = head.size();
    if (m_kind != Kind::Las) head.resize(head.size() + 8);  // where the chunk table will stand
    return m_file.write(head);
  }

  Result<void> addToChunks(const PointBatch& batch) {
    if (m_pending.empty()) m_pending.emplace_back();
    auto& records = m_pending.back().records;
    if (auto ok = m_schema->encode(batch, m_path, records, m_totals); !ok) return ok;
    const std::size_t chunk = kChunkPoints * m_schema->recordLength();
    while (m_pending.back().records.size() >= chunk) {
      PendingChunk rest;
      auto& full = m_pending.back().records;
      rest.records.assign(full.begin() + static_cast<std::ptrdiff_t>(chunk), full.end());
      full.resize(chunk);
      m_pending.push_back(std::move(rest));
    }
    if (m_pending.size() <= 4 * static_cast<std::size_t>(workerCount())) return {};
    PendingChunk last = std::move(m_pending.back());
    m_pending.pop_back();
    if (auto ok = writeChunks(); !ok) return ok;
    m_pending.push_back(std::move(last));
    return {};
  }

  Result<void> addToCell(const PointBatch& batch, const std::optional<OctreeCell>& cell) {
    if (!cell)
      return fail("COPC is an octree, and these points belong to no cell of one", m_path,
                  "Write the points from a store, which has them in cells");
    if (m_pending.empty() || m_pending.back().cell != cell) {
      constexpr std::size_t kEnough = 64 << 20;
      if (m_pendingBytes > kEnough)
        if (auto ok = writeChunks(); !ok) return ok;
      const bool inRange = cell->depth >= 0 && cell->depth < 31 && std::min({cell->x, cell->y, cell->z}) >= 0 &&
                           std::max({cell->x, cell->y, cell->z}) < std::int64_t{1} << cell->depth;
      if (!inRange || m_nodes.contains(keyOf(*cell)))
        return fail(fmt::format("Cell {}-{}-{}-{} comes twice or is outside of the cube", cell->depth, cell->x, cell->y,
                                cell->z),
                    m_path, "Hand over each cell's points together");
      m_nodes[keyOf(*cell)] = {};
      m_pending.push_back({cell, {}, {}});
    }
    auto& records = m_pending.back().records;
    const std::size_t before = records.size();
    if (auto ok = m_schema->encode(batch, m_path, records, m_totals); !ok) return ok;
    m_pendingBytes += records.size() - before;
    return {};
  }

  Result<void> writeChunks() {
    const std::size_t length = m_schema->recordLength();
    parallelFor(m_pending.size(), 1, [&](std::size_t first, std::size_t last, int) {
      for (std::size_t i = first; i < last; ++i)
        if (auto& chunk = m_pending[i]; !chunk.records.empty())
          chunk.coded = laz::encodeChunk(m_layout.items, chunk.records.data(), chunk.records.size() / length);
    });
    for (const PendingChunk& chunk : m_pending) {
      if (chunk.records.empty()) continue;
      const LasRun run{m_file.position(), chunk.coded.size(), chunk.records.size() / length};
      if (chunk.cell) m_nodes[keyOf(*chunk.cell)] = run;
      m_chunks.push_back(run);
      if (auto ok = m_file.write(chunk.coded); !ok) return ok;
    }
    m_pending.clear();
    m_pendingBytes = 0;
    return {};
  }

  Result<void> writeTable() {
    const auto at = static_cast<std::int64_t>(m_file.position());
    if (auto ok = m_file.write(makeChunkTable(m_chunks, m_layout.chunkSize == LazLayout::kVariable)); !ok) return ok;
    return m_file.patch(m_pointsAt, std::as_bytes(std::span(&at, 1)));
  }

  using Key = std::tuple<int, std::int32_t, std::int32_t, std::int32_t>;
  static Key keyOf(const OctreeCell& cell) { return {cell.depth, cell.x, cell.y, cell.z}; }

  /// One page with every node, those above them without points included (copc.io, "Hierarchy VLR").
  Result<void> prepareHierarchy() {
    std::map<Key, LasRun> all = m_nodes;
    all[{0, 0, 0, 0}];
    for (const auto& [key, run] : m_nodes) {
      auto [depth, x, y, z] = key;
      while (depth > 0) {
        all.try_emplace({--depth, x >>= 1, y >>= 1, z >>= 1});
      }
    }
    std::vector<std::byte> page(32 * all.size());
    std::byte* at = page.data();
    for (const auto& [key, run] : all) {
      const auto& [depth, x, y, z] = key;
      const std::int32_t head[4] = {depth, x, y, z};
      const std::int32_t tail[2] = {static_cast<std::int32_t>(run.bytes), static_cast<std::int32_t>(run.count)};
      const std::uint64_t offset = run.count > 0 ? run.offset : 0;
      std::memcpy(at, head, 16);
      std::memcpy(at + 16, &offset, 8);
      std::memcpy(at + 24, tail, 8);
      at += 32;
    }
    CopcInfo info;
    info.halfSize = m_options.cubeSize / 2;
    info.centre = m_options.cubeCorner + info.halfSize;
    info.spacing = m_options.rootSpacing;
    // The hierarchy is the first extended record.
    info.rootOffset = m_file.position() + 60;
    info.rootSize = page.size();
    info.firstTime = m_totals.firstTime;
    info.lastTime = m_totals.lastTime;
    m_frame.records.front().payload = info.bytes();
    m_frame.extendedRecords.insert(m_frame.extendedRecords.begin(), {"copc", 1000, "COPC hierarchy", std::move(page)});
    return {};
  }

  Kind m_kind;
  std::string m_path;
  ScanWriteOptions m_options;
  LasOutputFile m_file;
  std::optional<LasSchema> m_schema;
  LasFileFrame m_frame;
  LazLayout m_layout;
  LasSchema::Totals m_totals;
  std::uint64_t m_pointsAt = 0;
  std::vector<std::byte> m_records;
  std::vector<PendingChunk> m_pending;
  std::size_t m_pendingBytes = 0;
  std::vector<LasRun> m_chunks;
  std::map<Key, LasRun> m_nodes;
};

bool endsWith(const std::string& path, std::string_view ending) {
  if (path.size() < ending.size()) return false;
  return std::equal(ending.begin(), ending.end(), path.end() - static_cast<std::ptrdiff_t>(ending.size()), [](char a, char b) {
    return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b);
  });
}

}  // namespace

ReaderDescription LasFormatWriter::description() const {
  switch (m_kind) {
    case Kind::Las: return {"las", "LAS point cloud", {"las"}};
    case Kind::Laz: return {"laz", "LAZ point cloud", {"laz"}};
    case Kind::Copc: break;
  }
  return {"copc", "Cloud-optimised point cloud (COPC)", {"copc.laz"}};
}

bool LasFormatWriter::writes(const std::string& path) const {
  if (m_kind == Kind::Las) return endsWith(path, ".las");
  return endsWith(path, ".copc.laz") ? m_kind == Kind::Copc : m_kind == Kind::Laz && endsWith(path, ".laz");
}

Result<std::unique_ptr<ScanSink>> LasFormatWriter::create(const std::string& path, const ScanWriteOptions& options) const {
  if (m_kind == Kind::Copc && !(options.cubeSize > 0))
    return fail("COPC is an octree, and no cube is given for it", path, "Write the points from a store, which has them in cells");
  auto file = LasOutputFile::create(path);
  if (!file) return fail(file.error());
  return std::make_unique<LasSink>(m_kind, path, options, std::move(*file));
}

}  // namespace alidade
