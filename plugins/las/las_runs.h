// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>

#include "base/progress.h"
#include "las/las_header.h"

namespace alidade {

/// Where a file's points stand: its chunks, or stretches of a LAS file. Nothing where the chunks must be
/// found by decoding one after the other.
Result<std::optional<std::vector<LasRun>>> runsOf(const ByteSource& file, const LasHeader& header);

/// Makes of records what is handed over; called on all threads at once. The call that follows in file
/// order on the calling thread takes it; false to stop.
using MakeBatch = std::function<std::function<bool()>(const std::byte* records, std::size_t count)>;

/// Reads the first `count` points of each run, decodes them on all cores and hands them over in the runs' order.
Result<void> readRuns(const ByteSource& file, const LasHeader& header, const std::vector<LasRun>& runs,
                      const MakeBatch& make, const Progress& progress, const std::string& what);

/// The same for all points of a compressed file without a chunk table, on one core.
Result<void> readWithoutTable(const ByteSource& file, const LasHeader& header, const MakeBatch& make,
                              const Progress& progress, const std::string& what);

/// All points.
Result<void> readAllPoints(const ByteSource& file, const LasHeader& header, const MakeBatch& make,
                           const Progress& progress, const std::string& what);

/// Takes records where they were decoded: on several threads at once, each with a number of its own below
/// workerCount(). `first` is the place of the first record among all points; false to stop.
using TakeRecords = std::function<bool(std::uint64_t first, const std::byte* records, std::size_t count, int worker)>;

/// All points, in any order.
Result<void> readAnyOrder(const ByteSource& file, const LasHeader& header, const TakeRecords& take, const Progress& progress,
                          const std::string& what);

/// Runs that hold about `wanted` points, spread evenly over the file.
std::vector<LasRun> sampleOf(const std::vector<LasRun>& runs, const LasHeader& header, std::uint64_t wanted);

}  // namespace alidade
