// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QWidget>

#include "ui/overlay_view.h"
#include "ui/session.h"

class QLabel;
class QToolButton;

namespace alidade {

/// Always visible: where the cursor is in the world and how sure that is, the pose and its
/// millimetres, points drawn, the worst drawn error, the time a picture takes.
class StatusLine : public QWidget {
  Q_OBJECT

 public:
  StatusLine(Session& session, OverlayView& view, QWidget* parent = nullptr);

 signals:
  void messagesWanted();

 private:
  void refreshCursor();
  void refreshPose();
  void refreshPicture();

  Session& m_session;
  OverlayView& m_view;
  QLabel* m_pixel;
  QLabel* m_world;
  QLabel* m_distance;
  QLabel* m_pose;
  QLabel* m_points;
  QLabel* m_error;
  QLabel* m_speed;
  QToolButton* m_problems;
  int m_problemCount = 0;
};

}  // namespace alidade
