// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/playback.h"

#include <algorithm>
#include <cmath>

namespace alidade {

Playback::Playback(Session& session, QObject* parent) : QObject(parent), m_session(session) {
  m_timer.setTimerType(Qt::PreciseTimer);
  connect(&m_timer, &QTimer::timeout, this, &Playback::tick);
  connect(&session, &Session::structureChanged, this, [this] { setPlaying(false); });
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
  if (on == playing()) return;
  if (!on) {
    m_timer.stop();
    emit changed();
    return;
  }
  const int count = static_cast<int>(m_session.project()->frames.size());
  if (count < 2) {
    emit changed();
    return;
  }
  if (m_session.frameIndex() >= count - 1) m_session.setFrameIndex(0);
  m_rate = cameraRate(*m_session.project());
  m_startIndex = m_session.frameIndex();
  m_dropped = m_shown = 0;
  m_shownPerSecond = 0;
  m_clock.start();
  m_timer.start(std::max(4, static_cast<int>(500.0 / m_rate)));
  emit changed();
}

void Playback::tick() {
  const double elapsed = static_cast<double>(m_clock.elapsed()) / 1000.0;
  const int last = static_cast<int>(m_session.project()->frames.size()) - 1;
  const int wanted = std::min(last, m_startIndex + static_cast<int>(std::floor(elapsed * m_rate)));
  const int now = m_session.frameIndex();
  if (wanted != now && !m_session.renderLoop().busy()) {
    m_dropped += std::max(0, wanted - now - 1);
    ++m_shown;
    m_shownPerSecond = m_shown / std::max(elapsed, 1e-3);
    m_session.keepMoving();
    m_session.setFrameIndex(wanted);
    emit changed();
  }
  if (m_session.frameIndex() >= last) setPlaying(false);
}

}  // namespace alidade
