// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <map>

#include <QTimer>
#include <QWidget>

#include "ui/job_list.h"

class QLabel;
class QProgressBar;
class QVBoxLayout;

namespace alidade {

/// One line a running job: what, how far, how long, cancel. Gone when nothing runs.
class JobStrip : public QWidget {
  Q_OBJECT

 public:
  explicit JobStrip(JobList& jobs, QWidget* parent = nullptr);

 private:
  struct Line {
    QWidget* widget = nullptr;
    QLabel* words = nullptr;
    QLabel* time = nullptr;
    QProgressBar* bar = nullptr;
    QWidget* cancel = nullptr;
  };
  void refresh();
  Line makeLine(int id);

  JobList& m_jobs;
  QVBoxLayout* m_layout;
  std::map<int, Line> m_lines;
  QTimer m_timer;
};

}  // namespace alidade
