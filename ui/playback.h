// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include "ui/session.h"

namespace alidade {

/// Plays the frames at the camera's rate. Where drawing is slower, frames are skipped, never slowed,
/// and counted.
class Playback : public QObject {
  Q_OBJECT

 public:
  explicit Playback(Session& session, QObject* parent = nullptr);

  bool playing() const { return m_timer.isActive(); }
  void setPlaying(bool on);
  void toggle() { setPlaying(!playing()); }
  int dropped() const { return m_dropped; }
  double shownPerSecond() const { return m_shownPerSecond; }

  /// Frames a second of the camera: the video's own, else the median step of the frame times, else 2.
  static double cameraRate(const Project& project);

 signals:
  void changed();

 private:
  void tick();

  Session& m_session;
  QTimer m_timer;
  QElapsedTimer m_clock;
  int m_startIndex = 0, m_dropped = 0, m_shown = 0;
  double m_rate = 2, m_shownPerSecond = 0;
};

}  // namespace alidade
