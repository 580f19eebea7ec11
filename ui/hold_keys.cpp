// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/hold_keys.h"

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QAbstractSpinBox>
#include <QApplication>
#include <QKeyEvent>
#include <QLineEdit>
#include <QMouseEvent>
#include <QPlainTextEdit>
#include <QTextEdit>
#include <QWidget>

namespace alidade {

namespace {

bool writesText(const QObject* object) {
  return qobject_cast<const QLineEdit*>(object) || qobject_cast<const QAbstractSpinBox*>(object) ||
         qobject_cast<const QTextEdit*>(object) || qobject_cast<const QPlainTextEdit*>(object);
}

/// Space presses a focused button and ticks a focused row; everywhere else it plays and pans.
bool wantsSpace(const QObject* object) {
  return qobject_cast<const QAbstractButton*>(object) || qobject_cast<const QAbstractItemView*>(object);
}

}  // namespace

HoldKeys::HoldKeys(QWidget& window) : QObject(&window), m_window(window) {
  qApp->installEventFilter(this);
}

void HoldKeys::onHold(int key, std::function<void(bool)> change) {
  m_handlers[key].change = std::move(change);
}

void HoldKeys::onScrub(int key, std::function<void(double)> move, std::function<void()> settled) {
  m_handlers[key].move = std::move(move);
  m_handlers[key].settled = std::move(settled);
}

void HoldKeys::release() {
  const auto it = m_handlers.find(m_held);
  m_held = 0;
  m_lastX.reset();
  if (it == m_handlers.end()) return;
  if (it->second.change) it->second.change(false);
  if (it->second.settled) it->second.settled();
}

bool HoldKeys::eventFilter(QObject* watched, QEvent* event) {
  switch (event->type()) {
    case QEvent::KeyPress: {
      auto* key = static_cast<QKeyEvent*>(event);
      const auto* widget = qobject_cast<QWidget*>(watched);
      const auto it = m_handlers.find(key->key());
      if (it == m_handlers.end() || !widget || widget->window() != &m_window || writesText(watched)) break;
      if (key->modifiers() & (Qt::ControlModifier | Qt::AltModifier | Qt::MetaModifier)) break;
      if (key->key() == Qt::Key_Space && wantsSpace(watched)) break;
      if (key->isAutoRepeat() || m_held == key->key()) return true;
      if (m_held) release();
      m_held = key->key();
      if (it->second.change) it->second.change(true);
      return true;
    }
    case QEvent::KeyRelease: {
      const auto* key = static_cast<QKeyEvent*>(event);
      if (m_held == 0 || key->key() != m_held) break;
      if (!key->isAutoRepeat()) release();
      return true;
    }
    case QEvent::MouseMove: {
      const auto it = m_handlers.find(m_held);
      if (it == m_handlers.end() || !it->second.move || !qobject_cast<QWidget*>(watched)) break;
      const auto* mouse = static_cast<QMouseEvent*>(event);
      const double x = mouse->globalPosition().x();
      if (m_lastX) it->second.move((x - *m_lastX) * (mouse->modifiers() & Qt::ShiftModifier ? 0.1 : 1.0));
      m_lastX = x;
      return true;
    }
    case QEvent::WindowDeactivate:
      if (watched == &m_window && m_held) release();
      break;
    default:
      break;
  }
  return QObject::eventFilter(watched, event);
}

}  // namespace alidade
