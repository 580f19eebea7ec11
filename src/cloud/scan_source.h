// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "base/error.h"
#include "base/progress.h"
#include "survey/point_batch.h"
#include "survey/point_records.h"
#include "survey/scan_notes.h"

namespace alidade {

/// A scan that is about to be indexed: what its header says, and how its points are had. Every call of `read`
/// gives the same points in the same order.
struct ScanSource {
  /// May take the batch's columns away; false stops early.
  using Sink = std::function<bool(PointBatch& batch)>;

  std::string name;      ///< for messages and the manifest
  std::string identity;  ///< changes when the source does: path, size, time
  ScanInfo info;
  ScanNotes notes;
  std::function<Result<void>(const Sink& sink, const Progress& progress)> read;
  /// The same points, handed over on the threads that made them, several at once; `number` tells the order that `read`
  /// would have. Empty: the source has no threads of its own.
  using NumberedSink = std::function<bool(std::uint64_t number, PointBatch& batch)>;
  std::function<Result<void>(const NumberedSink& sink, const Progress& progress)> readAnyOrder;
  /// The same points as the source's own records, on the threads that made them; false, and no point handed over, where
  /// they do not come so. Empty: they never do.
  std::function<Result<bool>(const RecordSink& sink, const Progress& progress)> readRecords;
  /// About `wanted` points taken evenly from the whole; empty: `read` is thinned.
  std::function<Result<void>(std::uint64_t wanted, const Sink& sink, const Progress& progress)> sample;
};

}  // namespace alidade
