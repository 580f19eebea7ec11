// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/frame_pacer.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace alidade {

namespace {

constexpr double kMostLess = 0.5, kMostMore = 1.25, kQuick = 0.8;

double millisecondsNow() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::uint64_t scaled(std::uint64_t points, double by) {
  return std::max(FramePacer::kFewest, static_cast<std::uint64_t>(static_cast<double>(points) * by));
}

}  // namespace

FramePacer::FramePacer() : FramePacer(millisecondsNow) {}

FramePacer::FramePacer(Clock clock) : m_clock(std::move(clock)) {}

std::uint64_t FramePacer::begin(const std::optional<FramePace>& pace) {
  m_start = m_clock();
  m_wanted = pace ? pace->frameTimeMs : 0;
  const std::uint64_t most = pace ? pace->mostPoints : 0;
  if (!(m_wanted > 0)) return most;
  // The first frame that moves has the still one before it to go by.
  if (m_budget == 0 && m_lastMs > m_wanted) m_budget = scaled(m_lastPoints, m_wanted / m_lastMs);
  return m_budget > 0 && most > 0 ? std::min(m_budget, most) : std::max(m_budget, most);
}

void FramePacer::end(std::uint64_t points) {
  const double ms = m_clock() - m_start;
  if (!(m_wanted > 0) || m_budget == 0) {
    m_lastMs = ms;
    m_lastPoints = points;
    return;
  }
  if (ms > m_wanted) m_budget = scaled(std::min(points, m_budget), std::max(kMostLess, m_wanted / ms));
  else if (ms < kQuick * m_wanted && points + points / 8 >= m_budget)  // else it did not need what it had
    m_budget = scaled(m_budget, std::min(kMostMore, ms > 0 ? m_wanted / ms : kMostMore));
}

}  // namespace alidade
