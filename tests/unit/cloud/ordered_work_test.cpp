// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/ordered_work.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <new>
#include <numeric>
#include <random>
#include <thread>

#include <gtest/gtest.h>

#include "cloud/key_sort.h"

namespace alidade {
namespace {

/// 120 items in a shuffled order, each after the one before it in number of the same ten; what was seen of them.
struct Works {
  static constexpr std::uint32_t kItems = 120;
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> previous;
  std::vector<char> finished = std::vector<char>(kItems, 0);
  std::vector<std::uint32_t> placed;
  std::atomic<std::uint64_t> atWork = 0, mostAtWork = 0;
  std::atomic<int> early = 0;
  OrderedWork work;

  Works() : order(kItems), previous(kItems) {
    std::iota(order.begin(), order.end(), 0u);
    for (std::uint32_t i = 0; i < kItems; ++i) previous[i] = i % 10 == 0 ? i : i - 1;
    work.order = order;
    work.before = [this](std::uint32_t item) { return std::span(&previous[item], item % 10 == 0 ? 0 : 1); };
    work.cost = [](std::uint32_t item) { return std::uint64_t{1} + item % 7 * 10; };
    work.most = 100;
    work.threads = 4;
    work.finished = &finished;
  }

  Result<void> run(const OrderedWork::Build& build, const Progress& progress = Progress()) {
    work.start = [build] { return build; };
    return work.run(progress);
  }

  OrderedWork::Built taking(std::uint32_t item, Result<void> end = {}) {
    return {[this, item] { placed.push_back(item); }, [this, item, end] {
              atWork -= work.cost(item);
              return end;
            }};
  }

  /// A while that has nothing to do with the order.
  Result<OrderedWork::Built> build(std::uint32_t item) {
    const std::uint64_t now = atWork += work.cost(item);
    for (std::uint64_t seen = mostAtWork; seen < now && !mostAtWork.compare_exchange_weak(seen, now);) continue;
    if (item % 10 != 0 && finished[item - 1] == 0) ++early;
    std::this_thread::sleep_for(std::chrono::microseconds(std::minstd_rand(item + 1)() % 900));
    return taking(item);
  }
};

TEST(OrderedWork, PlacesInOrderWhatIsBuiltInAny) {
  Works works;
  const auto done = works.run([&](std::uint32_t item) { return works.build(item); });
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_EQ(works.placed, works.order);
  EXPECT_EQ(works.early, 0) << "items begun before those that they wait for";
  EXPECT_LE(works.mostAtWork, works.work.most);
  EXPECT_GT(works.mostAtWork, 61u) << "more than one at a time";
  EXPECT_EQ(std::count(works.finished.begin(), works.finished.end(), 1), Works::kItems);
}

TEST(OrderedWork, WhatCostsMoreThanAllMayRunsAlone) {
  Works works;
  works.work.cost = [](std::uint32_t item) { return item == 40 ? std::uint64_t{1000} : std::uint64_t{20}; };
  const auto done = works.run([&](std::uint32_t item) { return works.build(item); });
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_EQ(works.placed, works.order);
  EXPECT_EQ(works.mostAtWork, 1000u);
}

TEST(OrderedWork, TheFirstFailureEndsItAndNothingIsPlacedAfterwards) {
  for (const bool inFinish : {false, true}) {
    Works works;
    const auto done = works.run([&](std::uint32_t item) -> Result<OrderedWork::Built> {
      if (item != 57) return works.build(item);
      if (inFinish) return works.taking(item, fail("The disk is full", "store", "Free some space"));
      return fail("The disk is full", "spill", "Free some space");
    });
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().what, "The disk is full");
    ASSERT_LE(works.placed.size(), 58u);
    EXPECT_TRUE(std::equal(works.placed.begin(), works.placed.end(), works.order.begin()));
    EXPECT_EQ(works.finished[57], 0);
  }
}

TEST(OrderedWork, EndsWhereMemoryRunsOutOrSomeoneCancels) {
  Works works;
  const auto out = works.run([&](std::uint32_t item) -> Result<OrderedWork::Built> {
    if (item == 31) throw std::bad_alloc();
    return works.build(item);
  });
  ASSERT_FALSE(out);
  EXPECT_NE(out.error().what.find("memory"), std::string::npos);

  Works others;
  const Progress progress;
  const auto cancelled = others.run([&](std::uint32_t item) {
    if (item == 60) progress.cancel();
    return others.build(item);
  }, progress);
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().what, cancelledError().what);
  EXPECT_LT(others.placed.size(), Works::kItems);
}

TEST(OrderedWork, GoesOnAfterWhatIsFinished) {
  Works works;
  std::vector<std::uint32_t> rest;
  for (std::uint32_t item = 0; item < Works::kItems; ++item)
    if (item % 10 < 4) works.finished[item] = 1;
    else rest.push_back(item);
  works.order = rest;
  works.work.order = works.order;
  const auto done = works.run([&](std::uint32_t item) { return works.build(item); });
  ASSERT_TRUE(done) << done.error().text();
  EXPECT_EQ(works.placed, rest);
  EXPECT_EQ(works.early, 0);
}

TEST(KeySort, SortsAsTheStandardLibraryDoes) {
  std::mt19937_64 random(3);
  for (const std::size_t count : {0, 1, 2, 7, 64, 257, 5000, 200'000}) {
    for (const std::uint64_t most : {~std::uint64_t{0}, std::uint64_t{1000}, std::uint64_t{1}}) {
      std::vector<std::uint64_t> keys(count);
      for (std::uint64_t& key : keys) key = most == ~std::uint64_t{0} ? random() : random() % (most + 1);
      std::vector<std::uint64_t> expected = keys;
      std::ranges::sort(expected);
      sortKeys(keys);
      EXPECT_EQ(keys, expected) << count << ' ' << most;
    }
  }
}

}  // namespace
}  // namespace alidade
