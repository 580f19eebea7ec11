// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/error.h"
#include "base/progress.h"

namespace alidade {

/// Items worked on by several threads whose results take their places in a fixed order.
///
/// An item starts when those before it have started, its predecessors (`before`) are finished, and the cost of
/// all at work stays below `most` (one item always may). `build` runs beside others; `place` is called for one
/// item after the other, in order, and hands out what depends on that order; `finish` runs beside others again. Who is
/// done before its turn leaves that to whoever comes before it, and goes on.
struct OrderedWork {
  std::span<const std::uint32_t> order;
  std::function<std::span<const std::uint32_t>(std::uint32_t item)> before;
  std::function<std::uint64_t(std::uint32_t item)> cost;
  std::uint64_t most = 0;
  int threads = 1;
  /// What is left to be done with an item, by any thread.
  struct Built {
    std::function<void()> place;
    std::function<Result<void>()> finish;
  };
  using Build = std::function<Result<Built>(std::uint32_t item)>;
  std::function<Build()> start;  ///< each thread calls it once for a `build` of its own
  std::vector<char>* finished = nullptr;  ///< by item; those set already count as finished

  /// The first failure, or the common error when cancelled.
  Result<void> run(const Progress& progress) const;
};

}  // namespace alidade
