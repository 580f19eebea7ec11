// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <deque>
#include <memory>

#include <QElapsedTimer>
#include <QObject>
#include <QTimer>

#include "app/play_quality.h"
#include "app/play_schedule.h"
#include "ui/session.h"

namespace alidade {

/// Plays the frames by their own times, see app/play_schedule.h. The render loop draws them; here they are only asked
/// for, kept and shown.
class Playback : public QObject {
  Q_OBJECT

 public:
  explicit Playback(Session& session, QObject* parent = nullptr);

  bool playing() const { return m_playing; }
  void setPlaying(bool on);
  void toggle() { setPlaying(!playing()); }
  double speed() const { return m_speed; }
  void setSpeed(double factor);
  int dropped() const { return m_droppedBefore + m_schedule.dropped(); }
  double shownPerSecond() const { return m_shownPerSecond; }
  /// True where full size does not keep up: see app/play_quality.h.
  bool atHalfSize() const { return m_quality.shrink() > 1; }

  /// Frames a second of the camera: the video's own, else the median step of the frame times, else 2.
  static double cameraRate(const Project& project);

 signals:
  void changed();

 private:
  void begin(int after);
  double now() const { return static_cast<double>(m_clock.nsecsElapsed()) * 1e-9; }
  void askForMore();
  void showDue();
  void stop();

  Session& m_session;
  PlaySchedule m_schedule;
  PlayQuality m_quality;
  QTimer m_due;
  QElapsedTimer m_clock;
  bool m_playing = false;
  double m_speed = 1, m_shownPerSecond = 0;
  int m_droppedBefore = 0;  ///< since Play, in runs that a jump or another speed ended
  int m_run = 0;            ///< so that a frame asked for before is told from one asked for since
  std::deque<std::shared_ptr<const RenderResult>> m_ready;
};

}  // namespace alidade
