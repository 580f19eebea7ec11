// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QFrame>

#include "ui/actions.h"

class QLineEdit;
class QListWidget;

namespace alidade {

/// Ctrl+K: type a few letters of a command, Enter runs it. No dialog: it hangs over the window's top
/// and goes away by itself.
class CommandPalette : public QFrame {
  Q_OBJECT

 public:
  CommandPalette(const Actions& actions, QWidget* window);
  void open();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void refill();
  void runCurrent();

  const Actions& m_actions;
  QLineEdit* m_edit;
  QListWidget* m_list;
};

/// How well `name` fits what was typed: 0 not at all; letters in order, more for whole words' starts.
int fitOf(const QString& name, const QString& typed);

}  // namespace alidade
