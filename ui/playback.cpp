// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/playback.h"

#include <algorithm>
#include <cmath>

namespace alidade {

Playback::Playback(Session& session, QObject* parent) : QObject(parent), m_session(session) {
  m_clock.start();
  m_due.setTimerType(Qt::PreciseTimer);
  m_due.setSingleShot(true);
  connect(&m_due, &QTimer::timeout, this, &Playback::showDue);
  connect(&session, &Session::structureChanged, this, [this] { setPlaying(false); });
  connect(&session, &Session::playedFailed, this, [this] { setPlaying(false); });
  connect(&session, &Session::playedReady, this, [this](const std::shared_ptr<const RenderResult>& result) {
    if (result->request.run != m_run) return;
    m_schedule.drawn();
    m_quality.drawn(result->decodeMs + result->renderMs, 1000 / (cameraRate(*m_session.project()) * m_speed));
    m_ready.push_back(result);
    showDue();
  });
  // Whoever goes to another frame by hand plays on from there.
  connect(&session, &Session::frameChanged, this, [this] {
    const auto& shown = m_session.rendered();
    if (m_playing && shown && shown->request.frame != m_session.frame()) begin(m_session.frameIndex() - 1);
  });
}

double Playback::cameraRate(const Project& project) {
  for (const Video& video : project.videos)
    if (video.framesPerSecond > 0) return video.framesPerSecond;
  std::vector<double> steps;
  for (std::size_t i = 1; i < project.frames.size(); ++i) {
    const double step = project.frames[i].timeSecs - project.frames[i - 1].timeSecs;
    if (step > 1e-4) steps.push_back(step);
  }
  if (steps.empty()) return 2.0;
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
  // Photos taken minutes apart are still leafed through.
  return std::clamp(1.0 / steps[steps.size() / 2], 0.5, 120.0);
}

void Playback::setPlaying(bool on) {
  if (on == m_playing) return;
  const int count = static_cast<int>(m_session.project()->frames.size());
  if (on && count < 2) {
    emit changed();
    return;
  }
  if (!on) return stop();
  m_playing = true;
  m_droppedBefore = 0;
  m_schedule = PlaySchedule();
  m_session.setPlaying(true);
  begin(m_session.frameIndex() >= count - 1 ? -1 : m_session.frameIndex());
  emit changed();
}

void Playback::setSpeed(double factor) {
  if (!(factor > 0) || factor == m_speed) return;
  m_speed = factor;
  if (m_playing) begin(m_session.frameIndex());
  emit changed();
}

void Playback::begin(int after) {
  m_session.renderLoop().dropPlayed();
  m_droppedBefore += m_schedule.dropped();
  m_ready.clear();
  ++m_run;
  m_shownPerSecond = 0;
  std::vector<double> secs;
  for (const Frame& frame : m_session.project()->frames) secs.push_back(frame.timeSecs);
  m_schedule.begin(std::move(secs), after, m_speed, now());
  askForMore();
}

void Playback::askForMore() {
  while (m_playing) {
    const auto order = m_schedule.order(now());
    if (!order) return;
    m_session.requestPlayed(order->frame, order->next, m_run, m_quality.shrink());
  }
}

void Playback::showDue() {
  if (!m_playing) return;
  if (m_schedule.takeDue(now())) {
    const auto result = m_ready.front();
    m_ready.pop_front();
    m_shownPerSecond = m_schedule.shownPerSecond(now());
    askForMore();
    m_session.showPlayed(result);
    emit changed();
  }
  if (!m_playing) return;
  if (m_schedule.finished()) return stop();
  if (const auto due = m_schedule.nextDue()) m_due.start(std::max(0, static_cast<int>(std::floor((*due - now()) * 1000))));
}

void Playback::stop() {
  m_playing = false;
  m_due.stop();
  m_ready.clear();
  ++m_run;
  m_session.setPlaying(false);
  emit changed();
}

}  // namespace alidade
