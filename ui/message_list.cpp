// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/message_list.h"

#include "ui/format.h"

namespace alidade {

QString Message::fullText() const {
  QString all = what;
  if (!where.isEmpty()) all += QStringLiteral(" (%1)").arg(where);
  if (!advice.isEmpty()) all += QStringLiteral(". ") + advice;
  return all;
}

int MessageList::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(m_messages.size());
}

QVariant MessageList::data(const QModelIndex& index, int role) const {
  if (!index.isValid() || index.row() >= rowCount()) return {};
  const Message& message = m_messages[static_cast<std::size_t>(index.row())];
  if (role == Qt::DisplayRole || role == Qt::ToolTipRole) return message.fullText();
  if (role == Qt::UserRole) return static_cast<int>(message.severity);
  return {};
}

void MessageList::add(Message message) {
  constexpr std::size_t kMost = 2000;  // a reader in trouble may warn about every line
  if (m_messages.size() >= kMost) {
    beginRemoveRows({}, 0, 0);
    m_messages.erase(m_messages.begin());
    endRemoveRows();
  }
  if (!message.time.isValid()) message.time = QDateTime::currentDateTime();
  beginInsertRows({}, rowCount(), rowCount());
  m_messages.push_back(std::move(message));
  endInsertRows();
  emit added(m_messages.back());
}

void MessageList::info(const QString& what) {
  Message message;
  message.what = what;
  add(std::move(message));
}

void MessageList::warn(const QString& what, const QString& where) {
  Message message;
  message.severity = Severity::Warning;
  message.what = what;
  message.where = where;
  add(std::move(message));
}

void MessageList::error(const Error& error, const QString& during) {
  if (isCancelled(error)) {
    info(during.isEmpty() ? tr("Cancelled") : tr("Cancelled: %1").arg(during));
    return;
  }
  Message message;
  message.severity = Severity::Error;
  message.what = text(error.what);
  message.where = text(error.where);
  message.advice = text(error.advice);
  add(std::move(message));
}

void MessageList::clear() {
  beginResetModel();
  m_messages.clear();
  endResetModel();
}

}  // namespace alidade
