// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QWidget>

#include "ui/session.h"

class QDoubleSpinBox;
class QLabel;
class QPushButton;

namespace alidade {

/// How pictures and poses of the current frame's trajectory agree in time: the clock offset with its uncertainty, set by
/// hand or estimated, and how long its camera takes to read its rows. Both are part of the work and can be undone.
class ClockPanel : public QWidget {
  Q_OBJECT

 public:
  explicit ClockPanel(Session& session, QWidget* parent = nullptr);

 private:
  const Trajectory* trajectory() const;
  void refresh();
  void setOffset();
  void setReadout();
  void estimate();

  Session& m_session;
  QLabel *m_name, *m_std, *m_poses, *m_times, *m_answer;
  QDoubleSpinBox *m_offset, *m_readout;
  QPushButton* m_estimate;
  bool m_running = false;
};

}  // namespace alidade
