// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/chunk_plan.h"
#include "cloud/lattice.h"
#include "cloud/point_schema.h"
#include "cloud/record_streams.h"
#include "cloud/scan_source.h"

namespace alidade {

/// How a point travels: x, y, z in its tile and RGB565 (8 bytes as in DisplayPoint), the exact coordinate
/// where the lattice has a column for it, the schema's columns, padding to 8 bytes.
struct RecordLayout {
  std::size_t exactAt = 8, columnsAt = 8, bytes = 8;
  RecordLayout() = default;
  RecordLayout(const Lattice& lattice, const PointSchema& schema)
      : columnsAt(8 + lattice.exactBytes()), bytes((columnsAt + schema.bytes() + 7) / 8 * 8) {}
};

/// A cell that received points.
struct FilledCell {
  PlanCell cell;
  std::uint32_t id = 0;  ///< in the runs
  std::uint32_t stream = 0;
  std::uint64_t count = 0;
};

struct DistributionOptions {
  int threads = 2;
  std::uint16_t brightestIntensity = 0;
};

struct DistributionResult {
  enum class Outcome { Done, OffLattice, NewColumns };
  Outcome outcome = Outcome::Done;
  std::vector<FilledCell> cells;  ///< Morton order
  std::uint32_t streamCount = 0;
  std::uint64_t dropped = 0;
  PointSchema schema;  ///< NewColumns: with what was met
};

/// Streams a plan needs: its own, and a few for tiles that the sample did not meet.
std::uint32_t streamsFor(const ChunkPlan& plan);

/// Reads the source once and sends every point to its cell's stream. Stops early where a point does not fit
/// the lattice or a batch brings columns that the schema lacks.
Result<DistributionResult> distribute(const ScanSource& source, const ChunkPlan& plan, const Lattice& lattice,
                                      const PointSchema& schema, const DistributionOptions& options,
                                      RecordStreams& streams, const Progress& progress);

}  // namespace alidade
