// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/part_stages.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "cloud/byte_pack.h"
#include "cloud/morton.h"
#include "cloud/ordered_work.h"
#include "cloud/record_columns.h"
#include "cloud/tree_join.h"

namespace alidade {

namespace {

/// A run of a loaded stream.
struct Run {
  std::uint32_t cell;
  std::uint32_t count;
  std::uint64_t batch;
  const std::byte* records;
};

/// Nothing where a run does not fit its extent.
std::optional<std::vector<Run>> runsOf(const RecordStreams::Loaded& loaded, std::size_t recordBytes) {
  std::vector<Run> runs;
  for (const auto& part : loaded.parts) {
    for (std::uint32_t at = 0; at + sizeof(RecordStreams::RunHeader) <= part.used;) {
      RecordStreams::RunHeader header;
      std::memcpy(&header, part.data + at, sizeof header);
      at += static_cast<std::uint32_t>(sizeof header);
      if (header.count > (part.used - at) / recordBytes) return std::nullopt;
      runs.push_back({header.cell, header.count, header.batch, part.data + at});
      at += static_cast<std::uint32_t>(header.count * recordBytes);
    }
  }
  return runs;
}

std::uint64_t placeOf(const std::byte* record) {
  std::uint64_t packed;
  std::memcpy(&packed, record, sizeof packed);
  return packed & 0xffffffffffffull;
}

UnitBox boxOf(const PlanCell& cell) {
  UnitBox box;
  box.low = (glm::i64vec3(cell.tile) << std::int64_t{16}) + glm::i64vec3(cell.corner());
  box.high = box.low + std::int64_t{cell.size() - 1};
  return box;
}

/// Before a record of what a cell left to the tree above: its level, where that was drawn.
constexpr std::size_t kTopHeader = sizeof(std::int64_t);

/// Frees what it holds, to the system: a heap keeps large pieces that were freed, and hardly finds a use for them.
template <class Holder>
void giveBack(Holder& holder) {
  holder = {};
#if defined(__GLIBC__)
  ::malloc_trim(0);
#endif
}

/// Of a DisplayPoint: what a record begins with.
constexpr std::size_t kPointBytes = 8;

}  // namespace

PartStages::PartStages(const Lattice& lattice, const PointSchema& schema, const TreeOptions& tree, DistributionResult spread,
                       std::unique_ptr<RecordStreams> streams, const PartOptions& options, PartSink& sink)
    : m_lattice(lattice), m_schema(schema), m_tree(tree), m_spread(std::move(spread)), m_streams(std::move(streams)),
      m_options(options), m_sink(sink), m_layout(lattice, schema) {
  std::vector<std::vector<std::uint32_t>> cellsOf(m_spread.streamCount);
  for (std::uint32_t c = 0; c < m_spread.cells.size(); ++c) {
    const FilledCell& filled = m_spread.cells[c];
    m_pointCount += filled.count;
    m_cellOfId[filled.id] = c;
    cellsOf[filled.stream].push_back(c);
    if (m_tiles.empty() || m_tiles.back().tile != filled.cell.tile) {
      m_tiles.emplace_back().tile = filled.cell.tile;
      m_tiles.back().firstCell = c;
    }
    m_tiles.back().lastCell = c + 1;
    m_tiles.back().isCut = m_tiles.back().isCut || filled.cell.depth > 0;
  }
  std::vector<UnitBox> boxes;
  for (std::uint32_t s = 0; s < cellsOf.size(); ++s) {
    if (cellsOf[s].empty()) continue;
    UnitBox box;
    std::uint64_t points = 0;
    for (const std::uint32_t c : cellsOf[s]) box.add(boxOf(m_spread.cells[c].cell)), points += m_spread.cells[c].count;
    boxes.push_back(box);
    m_usedStreams.push_back(s);
    m_cellsOf.push_back(std::move(cellsOf[s]));
    m_streamPoints.push_back(points);
  }
  m_streamOrder = workOrderOf(boxes, 1);
  boxes.clear();
  for (const Tile& tile : m_tiles) boxes.push_back(boxOf({tile.tile, 0, {}}));
  m_tileOrder = workOrderOf(boxes, 1);
  m_done.resize(m_spread.cells.size());
  m_streamDone.assign(m_usedStreams.size(), 0);
  m_ends.resize(m_usedStreams.size());
}

Result<void> PartStages::begin() {
  if (auto begun = m_sink.begin(m_pointCount, m_lattice, m_schema, false); !begun) return begun;
  if (!m_streams->hasSpilled()) return {};
  if (auto spilled = m_streams->spillAll(); !spilled) return spilled;
  m_keepsDiary = true;
  BytePacker note;
  note.put(m_lattice);
  note.put(m_schema.rgbWhite);
  note.put<std::uint64_t>(m_schema.columns.size());
  for (const ColumnShape& column : m_schema.columns) {
    note.putText(column.name);
    note.put(column.type), note.put(column.components), note.put(column.extra), note.put(column.ordinal);
  }
  note.put(m_tree);
  note.put(m_spread.streamCount), note.put(m_spread.dropped);
  note.putAll(m_spread.cells);
  note.put<std::uint64_t>(m_streams->options().extentBytes);
  for (const auto& extents : m_streams->extents()) note.putAll(extents);
  return m_sink.note(note.bytes);
}

Result<std::unique_ptr<PartStages>> PartStages::resume(const std::vector<std::vector<std::byte>>& diary, const PartOptions& options,
                                                       PartSink& sink) {
  ByteUnpacker note(diary[0]);
  const auto damaged = [] { return fail("The diary of the unfinished work is damaged"); };
  const auto lattice = note.get<Lattice>();
  PointSchema schema;
  schema.rgbWhite = note.get<std::uint16_t>();
  for (auto left = note.get<std::uint64_t>(); left > 0 && note.ok(); --left) {
    ColumnShape column;
    column.name = note.getText();
    column.type = note.get<NumberType>(), column.components = note.get<int>();
    column.extra = note.get<bool>(), column.ordinal = note.get<int>();
    schema.columns.push_back(column);
  }
  const auto tree = note.get<TreeOptions>();
  DistributionResult spread;
  spread.streamCount = note.get<std::uint32_t>(), spread.dropped = note.get<std::uint64_t>();
  spread.cells = note.getAll<FilledCell>();
  RecordStreams::Options streamOptions;
  streamOptions.extentBytes = note.get<std::uint64_t>();
  streamOptions.recordBytes = RecordLayout(lattice, schema).bytes;
  streamOptions.spillPath = sink.spillPath();
  if (!note.ok() || spread.streamCount > (1u << 28) || streamOptions.extentBytes == 0) return damaged();
  std::vector<std::vector<RecordStreams::Extent>> extents;
  for (std::uint32_t s = 0; s < spread.streamCount && note.ok(); ++s) extents.push_back(note.getAll<RecordStreams::Extent>());
  if (!note.ok()) return damaged();
  auto streams = std::make_unique<RecordStreams>(streamOptions);
  if (auto opened = streams->reopen(std::move(extents)); !opened) return fail(opened.error());
  auto stages = std::make_unique<PartStages>(lattice, schema, tree, std::move(spread), std::move(streams), options, sink);
  stages->m_keepsDiary = true;
  for (std::size_t i = 1; i < diary.size(); ++i)
    if (!stages->readNote(diary[i])) break;
  if (auto begun = sink.begin(stages->m_pointCount, lattice, schema, true); !begun) return fail(begun.error());
  return stages;
}

std::vector<std::byte> PartStages::noteOf(std::uint32_t stream, const Output& output, const Offsets& at) const {
  BytePacker note;
  note.put(stream), note.put(at);
  note.put<std::uint64_t>(output.points);
  note.put<std::uint64_t>(output.columns[PartSink::kTables].size()), note.put<std::uint64_t>(output.columns[PartSink::kTops].size());
  note.put<std::uint64_t>(output.cells.size());
  for (const auto& [cell, done] : output.cells) {
    note.put(cell), note.put(done.topsAt), note.put(done.tops);
    note.putAll(done.nodes);
    note.putAll(done.borders);
  }
  return std::move(note.bytes);
}

/// Entries of streams that were done, in any order; what follows the first gap is done again.
bool PartStages::readNote(const std::vector<std::byte>& bytes) {
  ByteUnpacker note(bytes);
  const auto stream = note.get<std::uint32_t>();
  const auto at = note.get<Offsets>();
  const auto points = note.get<std::uint64_t>(), tables = note.get<std::uint64_t>(), tops = note.get<std::uint64_t>();
  if (!note.ok() || stream >= m_streamDone.size()) return false;
  for (auto left = note.get<std::uint64_t>(); left > 0 && note.ok(); --left) {
    const auto cell = note.get<std::uint32_t>();
    CellDone done;
    done.topsAt = note.get<std::uint64_t>(), done.tops = note.get<std::uint32_t>();
    done.nodes = note.getAll<BuildNode>();
    done.borders = note.getAll<BorderSample>();
    if (!note.ok() || cell >= m_done.size()) return false;
    m_done[cell] = std::move(done);
  }
  if (!note.ok()) return false;
  m_streamDone[stream] = 1;
  m_ends[stream] = {at.points + points, at.tables + tables / sizeof(std::uint32_t), at.tops + tops};
  while (m_finished < m_streamOrder.order.size() && m_streamDone[m_streamOrder.order[m_finished]])
    m_next = m_ends[m_streamOrder.order[m_finished++]];
  return true;
}

std::uint64_t PartStages::costOf(std::uint32_t stream) const {
  // Records as loaded, cell by cell and as written, keys, places twice, lists of two passes, the tree's lists.
  return m_streamPoints[stream] * (3 * m_layout.bytes + 8 + 100);
}

void PartStages::releaseBorders(std::uint32_t stream) {
  const auto free = [&](std::uint32_t s) {
    for (const std::uint32_t c : m_cellsOf[s]) m_done[c].borders = {};
  };
  for (const std::uint32_t before : m_streamOrder.before[stream])
    if (--m_waiting[before] == 0) free(before);
  if (m_waiting[stream] == 0) free(stream);
}

/// Appends the tree's points, in its order, to the output; its point i is the record at records + rows[i] * stride.
void PartStages::emit(Output& output, const SubTree& tree, const std::byte* records, std::size_t stride,
                      std::span<const std::uint32_t> rows, CellDone& done) {
  done.nodes = tree.nodes;
  auto& tables = output.columns[PartSink::kTables];
  for (BuildNode& node : done.nodes) {
    node.first += output.points;
    node.tableOffset += tables.size() / sizeof(std::uint32_t);
  }
  const auto* from = reinterpret_cast<const std::byte*>(tree.tables.data());
  tables.insert(tables.end(), from, from + tree.tables.size() * sizeof(std::uint32_t));

  std::vector<std::size_t> widths{kPointBytes, m_lattice.exactBytes()};
  for (const ColumnShape& column : m_schema.columns) widths.push_back(column.bytes());
  const std::uint64_t first = output.points;
  output.points += tree.order.size();
  std::vector<std::byte*> out;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    auto& column = output.columns[i < 2 ? i : i - 2 + PartSink::kFirstAttribute];
    column.resize(output.points * widths[i]);
    out.push_back(column.data() + first * widths[i]);
  }
  RecordColumns columns(std::move(widths), m_layout.bytes);
  // Some records at a time: their columns are then taken from the nearest memory there is.
  constexpr std::size_t kBlock = RecordColumns::kBlock;
  constexpr std::size_t kAhead = 64;  // records asked for before they are wanted
  std::array<const std::byte*, kBlock + kAhead> at{};
  const std::size_t all = tree.order.size();
  const auto locate = [&](std::size_t begin, std::size_t end, const std::byte** to) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::byte* record = records + rows[tree.order[i]] * stride;
      __builtin_prefetch(record), __builtin_prefetch(record + m_layout.bytes - 1);
      *to++ = record;
    }
  };
  locate(0, std::min(kAhead, all), at.data());
  for (std::size_t start = 0; start < all; start += kBlock) {
    const std::size_t count = std::min(kBlock, all - start);
    locate(std::min(start + kAhead, all), std::min(start + kBlock + kAhead, all), at.data() + kAhead);
    columns.take(at.data(), count, out);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += count * columns.widths()[i];
    std::copy_n(at.begin() + kBlock, kAhead, at.begin());
  }
}

void PartStages::Output::clear() {
  for (auto& column : columns) column.clear();
  points = 0;
  cells.clear();
}

Result<void> PartStages::buildStream(std::uint32_t stream, Workshop& shop, Output& output) {
  auto& [noise, keys, points, records, packed] = shop;
  output.clear();
  output.columns.resize(columnCount());
  auto loaded = m_streams->load(m_usedStreams[stream]);
  if (!loaded) return fail(loaded.error());
  const auto damaged = [this] { return fail(kDamagedSpill, m_streams->options().spillPath, "Index the scan again"); };
  auto found = runsOf(*loaded, m_layout.bytes);
  if (!found) return damaged();
  std::vector<Run>& runs = *found;
  for (Run& run : runs) {
    const auto cell = m_cellOfId.find(run.cell);
    if (cell == m_cellOfId.end()) return damaged();
    run.cell = cell->second;
  }
  std::stable_sort(runs.begin(), runs.end(),
                   [](const Run& a, const Run& b) { return a.cell != b.cell ? a.cell < b.cell : a.batch < b.batch; });
  output.columns[PartSink::kPoints].reserve(m_streamPoints[stream] * kPointBytes);
  output.columns[PartSink::kExact].reserve(m_streamPoints[stream] * m_lattice.exactBytes());
  for (std::size_t c = 0; c < m_schema.columns.size(); ++c)
    output.columns[PartSink::kFirstAttribute + c].reserve(m_streamPoints[stream] * m_schema.columns[c].bytes());
  auto& tops = output.columns[PartSink::kTops];
  std::size_t next = 0;
  for (const std::uint32_t c : m_cellsOf[stream]) {
    const PlanCell& cell = m_spread.cells[c].cell;
    const std::uint64_t count = m_spread.cells[c].count;
    records.resize(count * m_layout.bytes), packed.resize(count);
    std::uint64_t taken = 0;
    for (; next < runs.size() && runs[next].cell == c; ++next) {
      const Run& run = runs[next];
      if (run.count > count - taken) return damaged();
      std::memcpy(records.data() + taken * m_layout.bytes, run.records, run.count * m_layout.bytes);
      for (std::uint32_t i = 0; i < run.count; ++i) packed[taken + i] = placeOf(run.records + i * m_layout.bytes);
      taken += run.count;
    }
    if (taken != count) return damaged();
    sortCell(cell, packed, keys, points);
    const int coarsest = cell.depth > 0 ? cell.depth : kCoarsestPass;
    std::vector<Obstacle> obstacles;
    if (m_tree.kind == LevelKind::BlueNoise) {
      for (const std::uint32_t other : m_streamOrder.before[stream])
        for (const std::uint32_t n : m_cellsOf[other])
          addObstacles(m_spread.cells[n].cell, m_done[n].borders, cell, coarsest, obstacles);
      for (const auto& [n, done] : output.cells) addObstacles(m_spread.cells[n].cell, done.borders, cell, coarsest, obstacles);
    }
    const std::vector<std::uint32_t> undecided = assignLevels(cell, points, obstacles, m_tree, noise);
    CellDone done;
    if (m_tree.kind == LevelKind::BlueNoise) done.borders = borderSamples(cell, points, undecided);
    emit(output, buildCellTree(cell, points, undecided, m_tree), records.data(), m_layout.bytes, points.row, done);
    done.topsAt = tops.size();
    done.tops = static_cast<std::uint32_t>(undecided.size());
    tops.resize(done.topsAt + undecided.size() * (kTopHeader + m_layout.bytes));
    std::byte* out = tops.data() + done.topsAt;
    for (const std::uint32_t i : undecided) {
      const std::int64_t level = points.level[i];
      std::memcpy(out, &level, kTopHeader);
      std::memcpy(out + kTopHeader, records.data() + points.row[i] * m_layout.bytes, m_layout.bytes);
      out += kTopHeader + m_layout.bytes;
    }
    output.cells.emplace_back(c, std::move(done));
  }
  return {};
}

Result<void> PartStages::buildTile(std::uint32_t t, Output& output) {
  output.columns.resize(columnCount());
  Tile& tile = m_tiles[t];
  if (!tile.isCut) return {};
  std::vector<PlanCell> cells;
  std::vector<std::byte> bytes;
  TopPoints top;
  const std::size_t each = kTopHeader + m_layout.bytes;
  for (std::size_t c = tile.firstCell; c < tile.lastCell; ++c) {
    cells.push_back(m_spread.cells[c].cell);
    const CellDone& done = m_done[c];
    const std::size_t at = bytes.size();
    bytes.resize(at + done.tops * each);
    if (auto ok = m_sink.read(PartSink::kTops, done.topsAt, std::span(bytes).subspan(at)); !ok) return fail(ok.error());
    top.cellDepth.insert(top.cellDepth.end(), done.tops, static_cast<std::int8_t>(cells.back().depth));
  }
  for (std::size_t at = 0; at < bytes.size(); at += each) {
    const std::uint64_t place = placeOf(bytes.data() + at + kTopHeader);
    std::int64_t level;
    std::memcpy(&level, bytes.data() + at, kTopHeader);
    top.points.row.push_back(static_cast<std::uint32_t>(top.points.row.size()));
    top.points.x.push_back(static_cast<std::uint16_t>(place));
    top.points.y.push_back(static_cast<std::uint16_t>(place >> 16));
    top.points.z.push_back(static_cast<std::uint16_t>(place >> 32));
    top.points.code.push_back(mortonOf(place & 0xffff, place >> 16 & 0xffff, place >> 32 & 0xffff));
    top.points.level.push_back(static_cast<std::int16_t>(level));
  }
  std::vector<Obstacle> obstacles;
  const PlanCell whole{tile.tile, 0, {}};
  if (m_tree.kind == LevelKind::BlueNoise) {
    for (const std::uint32_t n : m_tileOrder.before[t])
      if (m_tiles[n].isCut) addObstacles({m_tiles[n].tile, 0, {}}, m_tiles[n].borders, whole, kCoarsestPass, obstacles);
  }
  BlueNoise noise;
  assignTopLevels(tile.tile, top, obstacles, m_tree, noise);
  if (m_tree.kind == LevelKind::BlueNoise) tile.borders = borderSamples(whole, top.points, {});
  CellDone done;
  emit(output, buildTopTree(tile.tile, cells, top), bytes.empty() ? nullptr : bytes.data() + kTopHeader, each, top.points.row, done);
  output.cells.emplace_back(t, std::move(done));
  return {};
}

/// Writes an output where it belongs; its nodes then count over the whole part.
Result<void> PartStages::commit(Output& output, const Offsets& at) {
  for (auto& [cell, done] : output.cells) {
    done.topsAt += at.tops;
    for (BuildNode& node : done.nodes) node.first += at.points, node.tableOffset += at.tables;
  }
  for (std::size_t column = 0; column < output.columns.size(); ++column) {
    const RawVector<std::byte>& bytes = output.columns[column];
    if (bytes.empty()) continue;
    std::uint64_t offset = at.points * (output.points > 0 ? bytes.size() / output.points : 0);
    if (column == PartSink::kTables) offset = at.tables * sizeof(std::uint32_t);
    if (column == PartSink::kTops) offset = at.tops;
    if (auto ok = m_sink.write(column, offset, bytes); !ok) return ok;
  }
  return {};
}

PartStages::Offsets PartStages::place(const Output& output) {
  const Offsets at = m_next;
  m_next.points += output.points;
  m_next.tables += output.columns[PartSink::kTables].size() / sizeof(std::uint32_t);
  m_next.tops += output.columns[PartSink::kTops].size();
  return at;
}

class PartStages::Shelf {
 public:
  struct Item {
    Output output;
    Offsets at;
  };
  std::shared_ptr<Item> take() {
    std::lock_guard lock(m_mutex);
    if (m_items.empty()) return std::make_shared<Item>();
    auto item = std::move(m_items.back());
    m_items.pop_back();
    return item;
  }
  void giveBack(std::shared_ptr<Item> item) {
    std::lock_guard lock(m_mutex);
    m_items.push_back(std::move(item));
  }

 private:
  std::mutex m_mutex;
  std::vector<std::shared_ptr<Item>> m_items;
};

Result<PartTree> PartStages::run(const Progress& progress) {
  std::mutex noteMutex, bordersMutex;
  Shelf shelf;
  OrderedWork work;
  work.threads = m_options.threads;
  // Half of the memory: the rest is for what stays, and for what a heap never gives back.
  work.most = m_options.memoryBytes / 2;
  // Whatever came after the first gap is done again.
  for (std::size_t i = m_finished; i < m_streamOrder.order.size(); ++i) m_streamDone[m_streamOrder.order[i]] = 0;
  work.order = std::span(m_streamOrder.order).subspan(m_finished);
  m_waiting.assign(m_usedStreams.size(), 0);
  for (const auto& before : m_streamOrder.before)
    for (const std::uint32_t s : before) ++m_waiting[s];
  for (std::uint64_t i = 0; i < m_finished; ++i) releaseBorders(m_streamOrder.order[i]);
  work.before = [this](std::uint32_t s) { return std::span<const std::uint32_t>(m_streamOrder.before[s]); };
  work.cost = [this](std::uint32_t s) { return costOf(s); };
  work.finished = &m_streamDone;
  work.start = [&]() -> OrderedWork::Build {
    return [&, shop = std::make_shared<Workshop>()](std::uint32_t s) -> Result<OrderedWork::Built> {
      // What is kept counts as no other stream's: no thread keeps more than its share.
      const bool keeps = costOf(s) <= work.most / static_cast<std::uint64_t>(m_options.threads);
      auto item = shelf.take();
      if (auto built = buildStream(s, *shop, item->output); !built) return fail(built.error());
      m_streams->release(m_usedStreams[s]);
      if (!keeps) giveBack(*shop);
      OrderedWork::Built left;
      left.place = [this, item] { item->at = place(item->output); };
      left.finish = [&, item, s, keeps]() -> Result<void> {
        if (auto ok = commit(item->output, item->at); !ok) return ok;
        if (m_keepsDiary) {
          const std::vector<std::byte> note = noteOf(s, item->output, item->at);
          std::lock_guard lock(noteMutex);
          if (auto ok = m_sink.note(note); !ok) return ok;
        }
        for (auto& [cell, done] : item->output.cells) m_done[cell] = std::move(done);
        {
          std::lock_guard lock(bordersMutex);
          releaseBorders(s);
        }
        if (keeps) shelf.giveBack(item);
        else giveBack(item->output);
        return {};
      };
      return left;
    };
  };
  if (auto ok = work.run(progress.part(0.0, 0.95)); !ok) return fail(ok.error());

  std::vector<char> tileDone(m_tiles.size(), 0);
  work.order = m_tileOrder.order;
  work.before = [this](std::uint32_t t) { return std::span<const std::uint32_t>(m_tileOrder.before[t]); };
  work.cost = [this](std::uint32_t t) {
    std::uint64_t tops = 0;
    for (std::size_t c = m_tiles[t].firstCell; c < m_tiles[t].lastCell; ++c) tops += m_done[c].tops;
    return tops * (2 * m_layout.bytes + 140);
  };
  work.finished = &tileDone;
  work.start = [&]() -> OrderedWork::Build {
    return [&](std::uint32_t t) -> Result<OrderedWork::Built> {
      auto item = std::make_shared<Shelf::Item>();
      if (auto built = buildTile(t, item->output); !built) return fail(built.error());
      OrderedWork::Built left;
      left.place = [this, item] { item->at = place(item->output); };
      left.finish = [this, item, t]() -> Result<void> {
        if (auto ok = commit(item->output, item->at); !ok) return ok;
        if (m_tiles[t].isCut) m_tiles[t].nodes = std::move(item->output.cells[0].second.nodes);
        return {};
      };
      return left;
    };
  };
  if (auto ok = work.run(progress.part(0.95, 1.0)); !ok) return fail(ok.error());
  if (m_next.points != m_pointCount) return fail("The index lost points; this is a fault of the program", {}, "Please report it");

  PartTree part;
  part.lattice = m_lattice;
  part.schema = m_schema;
  part.tree = m_tree;
  part.pointCount = m_pointCount;
  part.dropped = m_spread.dropped;
  part.tableCount = m_next.tables;
  std::vector<TileTree> trees;
  for (Tile& tile : m_tiles) {
    TileTree tree;
    tree.tile = tile.tile;
    tree.top = std::move(tile.nodes);
    for (std::size_t c = tile.firstCell; c < tile.lastCell; ++c) tree.cells.push_back(std::move(m_done[c].nodes));
    trees.push_back(std::move(tree));
  }
  part.nodes = joinTrees(trees);
  return part;
}

}  // namespace alidade
