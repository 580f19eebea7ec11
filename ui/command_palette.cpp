// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/command_palette.h"

#include <algorithm>

#include <QAction>
#include <QKeyEvent>
#include <QLineEdit>
#include <QListWidget>
#include <QTimer>
#include <QVBoxLayout>

namespace alidade {

int fitOf(const QString& name, const QString& typed) {
  if (typed.isEmpty()) return 1;
  if (name.contains(typed, Qt::CaseInsensitive))
    return name.startsWith(typed, Qt::CaseInsensitive) ? 1000 : 500;
  int score = 1;
  qsizetype at = 0;
  for (const QChar letter : typed.simplified()) {
    if (letter.isSpace()) continue;
    const qsizetype found = name.indexOf(letter, at, Qt::CaseInsensitive);
    if (found < 0) return 0;
    if (found == 0 || name[found - 1].isSpace()) score += 20;
    at = found + 1;
  }
  return score;
}

CommandPalette::CommandPalette(const Actions& actions, QWidget* window) : QFrame(window), m_actions(actions) {
  setObjectName(QStringLiteral("commandPalette"));
  setFrameShape(QFrame::StyledPanel);
  setAutoFillBackground(true);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 8, 8, 8);
  m_edit = new QLineEdit;
  m_edit->setPlaceholderText(tr("Find a command"));
  m_list = new QListWidget;
  m_list->setFocusPolicy(Qt::NoFocus);
  m_list->setIconSize({16, 16});
  m_list->setUniformItemSizes(true);
  layout->addWidget(m_edit);
  layout->addWidget(m_list);
  m_edit->installEventFilter(this);
  connect(m_edit, &QLineEdit::textChanged, this, &CommandPalette::refill);
  connect(m_edit, &QLineEdit::returnPressed, this, &CommandPalette::runCurrent);
  connect(m_list, &QListWidget::itemClicked, this, &CommandPalette::runCurrent);
  hide();
}

void CommandPalette::open() {
  const QWidget* window = parentWidget();
  const int width = std::min(560, window->width() - 80);
  setGeometry((window->width() - width) / 2, 70, width, std::min(420, window->height() - 140));
  m_edit->clear();
  refill();
  show();
  raise();
  m_edit->setFocus();
}

void CommandPalette::refill() {
  struct Row {
    int fit;
    QAction* action;
  };
  std::vector<Row> rows;
  for (const ActionSpec& spec : actionTable()) {
    QAction* action = m_actions[spec.command];
    if (spec.command == Command::CommandPalette || !action->isEnabled()) continue;
    if (const int fit = fitOf(action->text(), m_edit->text())) rows.push_back({fit, action});
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.fit > b.fit; });
  m_list->clear();
  for (const Row& row : rows) {
    const QString key = row.action->shortcut().toString(QKeySequence::NativeText);
    // A blank of the same size keeps the names in one column.
    QPixmap blank(16, 16);
    blank.fill(Qt::transparent);
    auto* item = new QListWidgetItem(
        row.action->icon().isNull() ? QIcon(blank) : row.action->icon(),
        key.isEmpty() ? row.action->text() : QStringLiteral("%1    %2").arg(row.action->text(), key));
    item->setToolTip(row.action->toolTip());
    item->setSizeHint({0, 26});
    item->setData(Qt::UserRole, row.action->objectName());
    m_list->addItem(item);
  }
  m_list->setCurrentRow(0);
}

void CommandPalette::runCurrent() {
  const QListWidgetItem* item = m_list->currentItem();
  const QString name = item ? item->data(Qt::UserRole).toString() : QString();
  hide();
  parentWidget()->setFocus();
  for (const auto& [command, action] : m_actions.all())
    if (action->objectName() == name) QTimer::singleShot(0, action, &QAction::trigger);
}

bool CommandPalette::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() == QEvent::FocusOut && isVisible()) hide();
  if (event->type() == QEvent::ShortcutOverride && static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
    event->accept();
    return true;
  }
  if (event->type() == QEvent::KeyPress) {
    const int key = static_cast<QKeyEvent*>(event)->key();
    if (key == Qt::Key_Escape) {
      hide();
      parentWidget()->setFocus();
      return true;
    }
    if (key == Qt::Key_Down || key == Qt::Key_Up) {
      const int row = m_list->currentRow() + (key == Qt::Key_Down ? 1 : -1);
      m_list->setCurrentRow(std::clamp(row, 0, std::max(0, m_list->count() - 1)));
      return true;
    }
  }
  return QFrame::eventFilter(watched, event);
}

}  // namespace alidade
