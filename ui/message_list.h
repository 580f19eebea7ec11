// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <vector>

#include <QAbstractListModel>
#include <QDateTime>

#include "base/error.h"

namespace alidade {

enum class Severity { Info, Note, Warning, Error };

/// A sentence for the user: what happened, where, what to do; with a button where a next step exists.
struct Message {
  Severity severity = Severity::Info;
  QString what;
  QString where;
  QString advice;
  QDateTime time;
  QString actionText;  ///< of the button; empty: none
  std::function<void()> action;

  QString fullText() const;  ///< all of it, for the clipboard
};

/// The session's messages, newest last. Shared by the message panel and the status bar.
class MessageList : public QAbstractListModel {
  Q_OBJECT

 public:
  using QAbstractListModel::QAbstractListModel;
  int rowCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;

  void add(Message message);
  void info(const QString& what);
  void warn(const QString& what, const QString& where = {});
  /// Cancelling is no failure: it is noted as information.
  void error(const Error& error, const QString& during = {});
  void clear();

  const std::vector<Message>& messages() const { return m_messages; }

 signals:
  void added(const alidade::Message& message);

 private:
  std::vector<Message> m_messages;
};

}  // namespace alidade
