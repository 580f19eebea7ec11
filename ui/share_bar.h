// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <QWidget>

#include "ui/picture_probe.h"

namespace alidade {

/// Visible, hidden and unknown of one element: a bar whose parts differ in fill and colour, and the
/// figures beneath.
class ShareBar : public QWidget {
  Q_OBJECT

 public:
  explicit ShareBar(QWidget* parent = nullptr);
  void setShares(const std::optional<ElementShares>& shares);
  QSize sizeHint() const override { return {200, 66}; }
  QSize minimumSizeHint() const override { return {140, 66}; }
  QString words() const;

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  std::optional<ElementShares> m_shares;
};

}  // namespace alidade
