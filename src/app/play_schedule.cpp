// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "app/play_schedule.h"

#include <algorithm>

namespace alidade {

namespace {

constexpr double kLongestStepSecs = 1.0, kShortestStepSecs = 1e-3;
/// Until the first frame is due: it finds nothing decoded and takes longer.
constexpr double kStartSecs = 0.2;
/// A timer is not exact.
constexpr double kEarlySecs = 1.5e-3;

}  // namespace

void PlaySchedule::begin(std::vector<double> frameSecs, int after, double speed, double now) {
  *this = PlaySchedule();
  m_secs = std::move(frameSecs);
  m_speed = speed > 0 ? speed : 1;
  m_ordered = std::clamp(after, -1, static_cast<int>(m_secs.size()) - 1);
  m_start = m_orderedDue = now + kStartSecs;
}

/// From the frame before; the first one ordered is due at the start.
double PlaySchedule::stepSecs(int to) const {
  if (to <= 0) return 0;
  const double step = m_secs[static_cast<std::size_t>(to)] - m_secs[static_cast<std::size_t>(to - 1)];
  return std::clamp(step, kShortestStepSecs, kLongestStepSecs) / m_speed;
}

std::optional<PlaySchedule::Order> PlaySchedule::order(double now) {
  const int last = static_cast<int>(m_secs.size()) - 1;
  if (m_ordered >= last || m_underWay.size() + m_drawn.size() >= std::size_t(kDrawnAhead)) return std::nullopt;
  Order order;
  order.frame = m_ordered + 1;
  double due = m_orderedDue + stepSecs(order.frame);
  while (order.frame < last && due + stepSecs(order.frame + 1) <= now) {
    due += stepSecs(order.frame + 1);
    ++order.frame;
    ++m_dropped;
  }
  for (int i = 1; i <= kDecodedAhead && order.frame + i <= last; ++i) order.next.push_back(order.frame + i);
  m_ordered = order.frame;
  m_orderedDue = due;
  m_underWay.push_back(due);
  return order;
}

void PlaySchedule::drawn() {
  if (m_underWay.empty()) return;
  m_drawn.push_back(m_underWay.front());
  m_underWay.pop_front();
}

bool PlaySchedule::takeDue(double now) {
  if (m_drawn.empty() || m_drawn.front() > now + kEarlySecs) return false;
  m_drawn.pop_front();
  ++m_shown;
  return true;
}

std::optional<double> PlaySchedule::nextDue() const {
  return m_drawn.empty() ? std::nullopt : std::optional(m_drawn.front());
}

bool PlaySchedule::finished() const {
  return m_ordered >= static_cast<int>(m_secs.size()) - 1 && m_underWay.empty() && m_drawn.empty();
}

double PlaySchedule::shownPerSecond(double now) const {
  // The first frame was shown at the start, the others after it.
  return m_shown > 1 ? (m_shown - 1) / std::max(now - m_start, 0.02) : 0;
}

}  // namespace alidade
