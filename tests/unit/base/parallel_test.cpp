// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/parallel.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace alidade {

TEST(ParallelFor, VisitsEveryIndexOnce) {
  std::vector<std::atomic<int>> visits(10'007);
  parallelFor(visits.size(), 13, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t i = first; i < last; ++i) ++visits[i];
  });
  for (const auto& count : visits) ASSERT_EQ(count, 1);
}

TEST(ParallelFor, KeepsAWorkerToOneChunkAtATime) {
  std::vector<std::atomic<int>> busy(workerCount());
  std::atomic<bool> clash{false};
  parallelFor(2000, 1, [&](std::size_t, std::size_t, int worker) {
    if (busy[worker].fetch_add(1) != 0) clash = true;
    parallelFor(10, 1, [&](std::size_t, std::size_t, int inner) {
      if (inner != worker) clash = true;
    });
    busy[worker].fetch_sub(1);
  });
  EXPECT_FALSE(clash);
}

TEST(ParallelFor, DoesNotWaitForAnotherThreadsCall) {
  std::atomic<int> done{0};
  std::atomic<bool> ended{false};
  parallelFor(4, 1, [&](std::size_t first, std::size_t, int) {
    if (first != 0) return;
    // The pool is taken until another thread has had its own loop.
    std::thread other([&] {
      parallelFor(100, 1, [&](std::size_t, std::size_t, int worker) { done += worker == 0; });
      ended = true;
    });
    other.join();
  });
  EXPECT_TRUE(ended);
  EXPECT_EQ(done, 100);
}

}  // namespace alidade
