// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QWidget>

#include "ui/actions.h"
#include "ui/playback.h"

class QComboBox;
class QLabel;

namespace alidade {

/// One tick a frame: pose quality by height, colour and pattern; annotations and findings as marks
/// above. Click or drag to go there.
class FrameStrip : public QWidget {
  Q_OBJECT

 public:
  explicit FrameStrip(Session& session, QWidget* parent = nullptr);
  QSize sizeHint() const override { return {400, 40}; }
  QSize minimumSizeHint() const override { return {120, 40}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  bool event(QEvent* event) override;

 private:
  int frameAt(double x) const;
  void paintTicks(QPainter& painter, const QRectF& area) const;
  void paintMarks(QPainter& painter, const QRectF& area) const;
  Session& m_session;
};

/// Previous, play, next, where we are, the strip and the list of frames.
class Timeline : public QWidget {
  Q_OBJECT

 public:
  Timeline(Session& session, Playback& playback, const Actions& actions, QWidget* parent = nullptr);

 private:
  void refresh();
  void refillList();

  Session& m_session;
  Playback& m_playback;
  FrameStrip* m_strip;
  QLabel* m_position;
  QLabel* m_time;
  QLabel* m_rate;
  QComboBox *m_speed, *m_list;
};

}  // namespace alidade
