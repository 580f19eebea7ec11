// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/cell_tree.h"
#include "cloud/scan_source.h"

namespace alidade {

struct IndexOptions {
  std::uint64_t memoryBytes = std::uint64_t{2} << 30;  ///< for the points at work; what does not fit is spilled
  LevelKind levels = LevelKind::BlueNoise;
  std::uint32_t seed = 1;        ///< of the draw behind random levels
  int dimensions = 3;            ///< n of the level law
  std::uint32_t leafPoints = 20000;
  int threads = 0;               ///< 0: the machine's cores
  bool append = false;           ///< to a store that exists, whose parts stay as they are
};

struct IndexReport {
  std::uint64_t points = 0;   ///< of the scans that were named, in the store
  std::uint64_t dropped = 0;  ///< not finite, or beyond any survey's coordinates
  std::size_t parts = 0;      ///< that the store holds now
  std::size_t kept = 0;       ///< scans that an earlier run, cut short, had already finished
  double seconds = 0;
  double pointsPerSecond = 0;  ///< of the scans that this run finished
};

/// Makes a store of scans, or adds them to one: a part a scan, each the same, byte for byte, whatever threads
/// and memory are. A run that is killed or cancelled leaves work behind that the same call goes on with; other
/// scans or options start anew. The store is there, or has grown, only when all is done.
Result<IndexReport> indexScans(std::span<const ScanSource> scans, const std::string& storePath, const IndexOptions& options,
                               const Progress& progress);

}  // namespace alidade
