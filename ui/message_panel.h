// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QWidget>

#include "ui/message_list.h"

class QVBoxLayout;
class QScrollArea;

namespace alidade {

/// What happened, newest at the bottom: sentences that can be copied, with a button where a next step
/// exists. Never takes the focus.
class MessagePanel : public QWidget {
  Q_OBJECT

 public:
  explicit MessagePanel(MessageList& messages, QWidget* parent = nullptr);

 private:
  void append(const Message& message);
  void clearRows();

  MessageList& m_messages;
  QScrollArea* m_area;
  QVBoxLayout* m_rows;
};

}  // namespace alidade
