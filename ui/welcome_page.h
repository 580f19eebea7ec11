// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QWidget>

#include "ui/actions.h"
#include "ui/project_files.h"

class QVBoxLayout;

namespace alidade {

/// The empty start: recent projects, the sample inspection, and a place to drop files.
class WelcomePage : public QWidget {
  Q_OBJECT

 public:
  WelcomePage(ProjectFiles& files, const Actions& actions, QWidget* parent = nullptr);
  void setDropHighlighted(bool on);

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  void refreshRecent();

  ProjectFiles& m_files;
  QVBoxLayout* m_recent;
  QWidget* m_drop;
};

}  // namespace alidade
