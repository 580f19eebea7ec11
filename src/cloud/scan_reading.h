// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>

#include "base/error.h"
#include "base/progress.h"
#include "cloud/scan_source.h"

namespace alidade {

/// Takes a batch. `worker`, in [0, threads), belongs to this call alone until it returns; false to stop. It must not throw.
using TakeBatch = std::function<bool(std::uint64_t number, PointBatch& batch, int worker)>;

/// The same for a run of the source's own records.
using TakeRecords = std::function<bool(std::uint64_t number, const PointRecords& records, int worker)>;

/// Hands over all points of a source on up to `threads` threads: on those that made them where the source has its own,
/// else on threads that take them from the reading one. As records where the source has them and `takeRecords` is not empty.
Result<void> readOnThreads(const ScanSource& source, int threads, const TakeBatch& take, const TakeRecords& takeRecords,
                           const Progress& progress);

}  // namespace alidade
