// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/message_panel.h"

#include <QApplication>
#include <QClipboard>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QScrollArea>
#include <QScrollBar>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/theme.h"

namespace alidade {

namespace {

constexpr int kMostRows = 200;

/// A sign and a colour, never a colour alone.
QLabel* signOf(Severity severity) {
  auto* sign = new QLabel;
  sign->setFixedWidth(18);
  sign->setAlignment(Qt::AlignTop | Qt::AlignHCenter);
  const ThemeColours& c = colours();
  QColor colour = c.dimText;
  switch (severity) {
    case Severity::Info:
      sign->setText(QStringLiteral("·"));
      break;
    case Severity::Note:
      sign->setText(QStringLiteral("→")), colour = c.accent;
      break;
    case Severity::Warning:
      sign->setText(QStringLiteral("▲")), colour = c.caution;
      break;
    case Severity::Error:
      sign->setText(QStringLiteral("✕")), colour = c.bad;
      break;
  }
  sign->setStyleSheet(QStringLiteral("color: %1; font-weight: 600;").arg(colour.name()));
  return sign;
}

}  // namespace

MessagePanel::MessagePanel(MessageList& messages, QWidget* parent) : QWidget(parent), m_messages(messages) {
  setObjectName(QStringLiteral("messagePanel"));
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(0, 0, 6, 4);
  m_area = new QScrollArea;
  m_area->setWidgetResizable(true);
  m_area->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* page = new QWidget;
  m_rows = new QVBoxLayout(page);
  m_rows->setContentsMargins(8, 6, 8, 6);
  m_rows->setSpacing(3);
  m_rows->addStretch(1);
  m_area->setWidget(page);
  layout->addWidget(m_area, 1);
  auto* side = new QVBoxLayout;
  auto* copy = new QToolButton;
  copy->setIcon(icon(QStringLiteral("copy")));
  copy->setToolTip(tr("Copy all messages"));
  auto* clear = new QToolButton;
  clear->setIcon(icon(QStringLiteral("delete")));
  clear->setToolTip(tr("Clear the messages"));
  side->addWidget(copy);
  side->addWidget(clear);
  side->addStretch(1);
  layout->addLayout(side);
  connect(copy, &QToolButton::clicked, this, [this] {
    QStringList lines;
    for (const Message& m : m_messages.messages())
      lines << m.time.toString(Qt::ISODate) + QStringLiteral("  ") + m.fullText();
    QApplication::clipboard()->setText(lines.join('\n'));
  });
  connect(clear, &QToolButton::clicked, &m_messages, &MessageList::clear);
  connect(&m_messages, &MessageList::added, this, &MessagePanel::append);
  connect(&m_messages, &QAbstractItemModel::modelReset, this, &MessagePanel::clearRows);
}

void MessagePanel::append(const Message& message) {
  auto* row = new QWidget;
  auto* layout = new QHBoxLayout(row);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(8);
  auto* time = new QLabel(message.time.toString(QStringLiteral("hh:mm:ss")));
  time->setProperty("role", "dim");
  time->setAlignment(Qt::AlignTop);
  layout->addWidget(time);
  layout->addWidget(signOf(message.severity));
  auto* words = new QLabel;
  words->setTextFormat(Qt::PlainText);
  words->setText(message.fullText());
  words->setWordWrap(true);
  words->setTextInteractionFlags(Qt::TextSelectableByMouse);
  words->setAlignment(Qt::AlignTop);
  layout->addWidget(words, 1);
  if (message.action) {
    auto* button = new QPushButton(message.actionText);
    button->setFocusPolicy(Qt::TabFocus);
    connect(button, &QPushButton::clicked, this, message.action);
    layout->addWidget(button, 0, Qt::AlignTop);
  }
  m_rows->insertWidget(m_rows->count() - 1, row);
  if (m_rows->count() - 1 > kMostRows) {
    QLayoutItem* oldest = m_rows->takeAt(0);
    delete oldest->widget();
    delete oldest;
  }
  QTimer::singleShot(
      0, this, [this] { m_area->verticalScrollBar()->setValue(m_area->verticalScrollBar()->maximum()); });
}

void MessagePanel::clearRows() {
  while (m_rows->count() > 1) {
    QLayoutItem* row = m_rows->takeAt(0);
    row->widget()->deleteLater();
    delete row;
  }
}

}  // namespace alidade
