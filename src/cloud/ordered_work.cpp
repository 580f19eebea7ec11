// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/ordered_work.h"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

namespace alidade {

Result<void> OrderedWork::run(const Progress& progress) const {
  std::mutex mutex;
  std::condition_variable changed;
  std::size_t taken = 0, started = 0, placed = 0;
  std::uint64_t atWork = 0;
  std::map<std::size_t, Built> waiting;  ///< built, not yet placed: by rank
  Result<void> outcome;
  bool stopped = false;
  const auto stop = [&](const Error& error) {
    std::lock_guard lock(mutex);
    if (!stopped) outcome = fail(error);
    stopped = true;
    changed.notify_all();
  };
  const auto work = [&] {
    const Build build = start();
    for (;;) {
      std::unique_lock lock(mutex);
      if (stopped || taken >= order.size()) return;
      const std::size_t rank = taken++;
      const std::uint32_t item = order[rank];
      const std::uint64_t itemCost = cost(item);
      const auto ready = [&] {
        if (started != rank || (atWork > 0 && atWork + itemCost > most)) return false;
        const auto predecessors = before(item);
        return std::all_of(predecessors.begin(), predecessors.end(), [&](std::uint32_t p) { return (*finished)[p] != 0; });
      };
      changed.wait(lock, [&] { return stopped || ready(); });
      if (stopped) return;
      ++started;
      atWork += itemCost;
      lock.unlock();
      changed.notify_all();

      if (progress.cancelled()) return stop(cancelledError());
      auto built = build(item);
      if (!built) return stop(built.error());
      lock.lock();
      waiting.emplace(rank, std::move(*built));
      while (!stopped && !waiting.empty() && waiting.begin()->first == placed) {
        const std::uint32_t next = order[placed++];
        const Built turn = std::move(waiting.extract(waiting.begin()).mapped());
        turn.place();
        lock.unlock();
        if (auto done = turn.finish(); !done) return stop(done.error());
        lock.lock();
        (*finished)[next] = 1;
        atWork -= cost(next);
        progress.report(static_cast<double>(placed) / static_cast<double>(order.size()), "Building the point store");
        changed.notify_all();
      }
    }
  };
  const auto guarded = [&] {
    try {
      work();
    } catch (const std::bad_alloc&) {
      stop({"There is not enough memory to index the scan", {}, "Close other programs or allow more memory"});
    }
  };
  std::vector<std::thread> pool;
  for (int t = 1; t < threads; ++t) pool.emplace_back(guarded);
  guarded();
  for (std::thread& thread : pool) thread.join();
  return outcome;
}

}  // namespace alidade
