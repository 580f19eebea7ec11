// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

namespace alidade {

namespace {

/// The worker whose body runs on this thread; -1 outside any body.
thread_local int t_worker = -1;

/// One batch at a time.
class Pool {
 public:
  static Pool& instance() {
    static Pool pool;
    return pool;
  }

  int size() const { return static_cast<int>(m_threads.size()) + 1; }

  /// False where another thread's batch has the pool: a picture must not wait for an index.
  bool run(std::size_t count, std::size_t grain,
           const std::function<void(std::size_t, std::size_t, int)>& body) {
    const std::unique_lock batch(m_batchMutex, std::try_to_lock);
    if (!batch) return false;
    {
      std::lock_guard lock(m_mutex);
      m_body = &body;
      m_count = count;
      m_grain = grain;
      m_next.store(0);
      m_busy = static_cast<int>(m_threads.size());
      ++m_generation;
    }
    m_wake.notify_all();
    work(0);
    std::unique_lock lock(m_mutex);
    m_done.wait(lock, [this] { return m_busy == 0; });
    m_body = nullptr;
    return true;
  }

 private:
  Pool() {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    for (int worker = 1; worker < cores; ++worker) m_threads.emplace_back([this, worker] { loop(worker); });
  }

  ~Pool() {
    {
      std::lock_guard lock(m_mutex);
      m_stop = true;
    }
    m_wake.notify_all();
    for (auto& thread : m_threads) thread.join();
  }

  void loop(int worker) {
    unsigned seen = 0;
    for (;;) {
      {
        std::unique_lock lock(m_mutex);
        m_wake.wait(lock, [&] { return m_stop || m_generation != seen; });
        if (m_stop) return;
        seen = m_generation;
      }
      work(worker);
      std::lock_guard lock(m_mutex);
      if (--m_busy == 0) m_done.notify_one();
    }
  }

  void work(int worker) {
    t_worker = worker;
    for (;;) {
      const std::size_t first = m_next.fetch_add(m_grain);
      if (first >= m_count) break;
      (*m_body)(first, std::min(first + m_grain, m_count), worker);
    }
    t_worker = -1;
  }

  std::vector<std::thread> m_threads;
  std::mutex m_batchMutex;
  std::mutex m_mutex;
  std::condition_variable m_wake;
  std::condition_variable m_done;
  const std::function<void(std::size_t, std::size_t, int)>* m_body = nullptr;
  std::size_t m_count = 0;
  std::size_t m_grain = 1;
  std::atomic<std::size_t> m_next{0};
  int m_busy = 0;
  unsigned m_generation = 0;
  bool m_stop = false;
};

}  // namespace

int workerCount() {
  return Pool::instance().size();
}

void parallelFor(std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t, std::size_t, int)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const auto alone = [&](int worker) {
    for (std::size_t first = 0; first < count; first += grain) body(first, std::min(first + grain, count), worker);
  };
  if (t_worker >= 0 || count <= grain) return alone(std::max(t_worker, 0));
  if (Pool::instance().run(count, grain, body)) return;
  t_worker = 0;
  alone(0);
  t_worker = -1;
}

}  // namespace alidade
