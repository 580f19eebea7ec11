// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "cloud/distribution.h"
#include "cloud/part_index.h"
#include "cloud/stream_order.h"

namespace alidade {

/// From points in streams to a tree: stages 3 and 4 of indexPart.
class PartStages {
 public:
  PartStages(const Lattice& lattice, const PointSchema& schema, const TreeOptions& tree, DistributionResult spread,
             std::unique_ptr<RecordStreams> streams, const PartOptions& options, PartSink& sink);
  /// Goes on where the diary ends; an Error where it does not say enough.
  static Result<std::unique_ptr<PartStages>> resume(const std::vector<std::vector<std::byte>>& diary, const PartOptions& options,
                                                    PartSink& sink);

  /// Opens the sink, and notes in its diary what the streams hold.
  Result<void> begin();
  Result<PartTree> run(const Progress& progress);

 private:
  /// A cell that is done: what is left of it in memory.
  struct CellDone {
    std::vector<BuildNode> nodes;  ///< points and tables counted over the whole part
    std::vector<BorderSample> borders;
    std::uint64_t topsAt = 0;      ///< bytes into the sink's tops
    std::uint32_t tops = 0;
  };
  /// What a stream adds to the sink's columns.
  struct Output {
    std::vector<RawVector<std::byte>> columns;  ///< by PartSink::Column
    std::uint64_t points = 0;
    std::vector<std::pair<std::uint32_t, CellDone>> cells;
    /// Nothing in it, but its memory kept: first touch of fresh memory costs more than what is written to it.
    void clear();
  };
  /// What a thread needs to build; kept from stream to stream, for the same reason.
  struct Workshop {
    BlueNoise noise;
    RawVector<std::uint64_t> keys;
    CellPoints points;
    RawVector<std::byte> records;  ///< of a cell, in the source's order
    RawVector<std::uint64_t> packed;
  };
  struct Offsets {
    std::uint64_t points = 0, tables = 0, tops = 0;
  };
  /// Outputs on their way to the sink.
  class Shelf;
  struct Tile {
    glm::ivec3 tile{0};
    std::size_t firstCell = 0, lastCell = 0;  ///< into m_spread.cells
    std::vector<BuildNode> nodes;             ///< above its cells, where it is cut
    std::vector<BorderSample> borders;
    bool isCut = false;
  };

  Result<void> buildStream(std::uint32_t stream, Workshop& shop, Output& output);
  Result<void> buildTile(std::uint32_t tile, Output& output);
  /// Where an output belongs that follows all placed before.
  Offsets place(const Output& output);
  std::size_t columnCount() const { return PartSink::kFirstAttribute + m_schema.columns.size(); }
  void emit(Output& output, const SubTree& tree, const std::byte* records, std::size_t stride,
            std::span<const std::uint32_t> rows, CellDone& done);
  Result<void> commit(Output& output, const Offsets& at);
  std::uint64_t costOf(std::uint32_t stream) const;
  /// Frees the border samples that no stream waits for any more, now that this one is done.
  void releaseBorders(std::uint32_t stream);
  std::vector<std::byte> noteOf(std::uint32_t stream, const Output& output, const Offsets& at) const;
  bool readNote(const std::vector<std::byte>& note);

  Lattice m_lattice;
  PointSchema m_schema;
  TreeOptions m_tree;
  DistributionResult m_spread;
  std::unique_ptr<RecordStreams> m_streams;
  const PartOptions& m_options;
  PartSink& m_sink;
  RecordLayout m_layout;
  std::uint64_t m_pointCount = 0;

  std::vector<std::uint32_t> m_usedStreams;                ///< streams that hold points
  std::vector<std::vector<std::uint32_t>> m_cellsOf;       ///< of each used stream, Morton order
  std::vector<std::uint64_t> m_streamPoints;
  std::unordered_map<std::uint32_t, std::uint32_t> m_cellOfId;
  WorkOrder m_streamOrder, m_tileOrder;
  std::vector<CellDone> m_done;  ///< by cell
  std::vector<std::uint32_t> m_waiting;  ///< by stream: how many will still look at its border samples
  std::vector<Tile> m_tiles;
  std::vector<char> m_streamDone;
  std::uint64_t m_finished = 0;  ///< streams that the diary vouches for, in work order
  std::vector<Offsets> m_ends;   ///< by used stream that the diary vouches for: where its output ends
  Offsets m_next;
  bool m_keepsDiary = false;
};

}  // namespace alidade
