// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <functional>

namespace alidade {

/// Threads that parallelFor spreads over, the caller included (the machine's cores).
int workerCount();

/// Runs `body(first, last, worker)` over [0, count) in chunks of at most `grain`, on the process's
/// one pool and on the calling thread; returns when all are done. `worker` is in
/// [0, workerCount()) and no two chunks of a call run at once with the same one, so it indexes the
/// call's per-thread buffers. Calls from inside a body, and while another thread's call has the pool, run on
/// the calling thread alone: a picture does not wait for an index. `body` must not throw.
void parallelFor(std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t first, std::size_t last, int worker)>& body);

}  // namespace alidade
