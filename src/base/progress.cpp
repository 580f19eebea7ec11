// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "base/progress.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>

namespace alidade {

struct Progress::State {
  Listener listener;
  std::atomic<bool> cancelled{false};
  std::mutex mutex;
  std::chrono::steady_clock::time_point last{};
};

Progress::Progress() : Progress(Listener{}) {}

Progress::Progress(Listener listener) : m_state(std::make_shared<State>()) {
  m_state->listener = std::move(listener);
}

void Progress::report(double fraction, std::string_view what) const {
  if (!m_state->listener) return;
  const double whole = m_from + (m_to - m_from) * std::clamp(fraction, 0.0, 1.0);
  std::lock_guard lock(m_state->mutex);
  const auto now = std::chrono::steady_clock::now();
  if (whole < 1.0 && now - m_state->last < std::chrono::milliseconds(30)) return;
  m_state->last = now;
  m_state->listener(whole, what);
}

bool Progress::cancelled() const {
  return m_state->cancelled.load(std::memory_order_relaxed);
}

void Progress::cancel() const {
  m_state->cancelled.store(true, std::memory_order_relaxed);
}

Progress Progress::part(double from, double to) const {
  Progress inner = *this;
  inner.m_from = m_from + (m_to - m_from) * from;
  inner.m_to = m_from + (m_to - m_from) * to;
  return inner;
}

}  // namespace alidade
