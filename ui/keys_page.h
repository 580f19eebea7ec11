// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QDialog>

namespace alidade {

/// Every key and mouse habit on one page, from the action table.
class KeysPage : public QDialog {
  Q_OBJECT

 public:
  explicit KeysPage(QWidget* parent = nullptr);
};

}  // namespace alidade
