// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/scan_reading.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace alidade {

namespace {

/// Batches on their way from the reader to the workers, and empty ones on their way back: first touch of
/// fresh memory costs more than filling it.
class BatchQueue {
 public:
  struct Item {
    std::uint64_t number = 0;
    PointBatch batch;
  };
  explicit BatchQueue(std::size_t most) : m_most(most) {}

  /// Takes the batch's columns, gives it used ones instead. False where the work has stopped.
  bool push(std::uint64_t number, PointBatch& batch) {
    std::unique_lock lock(m_mutex);
    m_changed.wait(lock, [&] { return m_full.size() < m_most || m_stopped; });
    if (m_stopped) return false;
    m_full.push_back({number, {}});
    std::swap(m_full.back().batch, batch);
    if (!m_empty.empty()) {
      std::swap(batch, m_empty.back());
      m_empty.pop_back();
    }
    lock.unlock();
    m_changed.notify_all();
    return true;
  }
  bool pop(Item& item) {
    std::unique_lock lock(m_mutex);
    if (item.batch.size() > 0 && m_empty.size() < m_most) m_empty.push_back(std::move(item.batch));
    m_changed.wait(lock, [&] { return !m_full.empty() || m_ended || m_stopped; });
    if (m_full.empty() || m_stopped) return false;
    item = std::move(m_full.front());
    m_full.pop_front();
    lock.unlock();
    m_changed.notify_all();
    return true;
  }
  void end() {
    std::lock_guard lock(m_mutex);
    m_ended = true;
    m_changed.notify_all();
  }
  void stop() {
    std::lock_guard lock(m_mutex);
    m_stopped = true;
    m_changed.notify_all();
  }

 private:
  std::size_t m_most;
  std::mutex m_mutex;
  std::condition_variable m_changed;
  std::deque<Item> m_full;
  std::vector<PointBatch> m_empty;
  bool m_ended = false, m_stopped = false;
};

/// Lends each worker to one thread at a time.
class Workers {
 public:
  explicit Workers(int count) {
    for (int w = count; w-- > 0;) m_free.push_back(w);
  }
  int borrow() {
    std::unique_lock lock(m_mutex);
    m_returned.wait(lock, [this] { return !m_free.empty(); });
    const int worker = m_free.back();
    m_free.pop_back();
    return worker;
  }
  void giveBack(int worker) {
    {
      std::lock_guard lock(m_mutex);
      m_free.push_back(worker);
    }
    m_returned.notify_one();
  }

 private:
  std::mutex m_mutex;
  std::condition_variable m_returned;
  std::vector<int> m_free;
};

}  // namespace

Result<void> readOnThreads(const ScanSource& source, int threads, const TakeBatch& take, const TakeRecords& takeRecords,
                           const Progress& progress) {
  Workers workers(threads);
  if (source.readRecords && takeRecords) {
    const auto sink = [&](std::uint64_t number, const PointRecords& records) {
      const int worker = workers.borrow();
      const bool more = !progress.cancelled() && takeRecords(number, records, worker);
      workers.giveBack(worker);
      return more;
    };
    const auto read = source.readRecords(sink, progress);
    if (!read) return fail(read.error());
    if (*read) return {};
  }
  if (source.readAnyOrder) {
    const auto sink = [&](std::uint64_t number, PointBatch& batch) {
      const int worker = workers.borrow();
      const bool more = !progress.cancelled() && take(number, batch, worker);
      workers.giveBack(worker);
      return more;
    };
    return source.readAnyOrder(sink, progress);
  }
  BatchQueue queue(static_cast<std::size_t>(threads) + 1);
  std::vector<std::thread> pool;
  for (int worker = 0; worker < threads; ++worker) {
    pool.emplace_back([&, worker] {
      BatchQueue::Item item;
      while (queue.pop(item))
        if (!take(item.number, item.batch, worker)) queue.stop();
    });
  }
  std::uint64_t number = 0;
  const auto read = source.read([&](PointBatch& batch) { return !progress.cancelled() && queue.push(number++, batch); }, progress);
  if (read) queue.end();
  else queue.stop();
  for (std::thread& thread : pool) thread.join();
  return read;
}

}  // namespace alidade
