// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <QWidget>

class QLineEdit;

namespace alidade {

/// A slider for what is tuned all day. Dragging is continuous and relative (no jump to the click);
/// Shift slows it tenfold; a double click returns to automatic; arrow keys step; typing a figure (or
/// Enter) opens a field for it.
class ValueSlider : public QWidget {
  Q_OBJECT

 public:
  struct Range {
    double low = 0, high = 1, automatic = 1;
    bool logarithmic = false;  ///< equal drags multiply; low must be above 0
    double displayFactor = 1;  ///< figure shown = value × factor
    int decimals = 0;
    QString unit;  ///< "%", "×"
  };
  ValueSlider(const QString& label, const QString& iconName, const Range& range, QWidget* parent = nullptr);

  double value() const { return m_value; }
  /// Shows a value that was set elsewhere; emits nothing.
  void setValue(double value);
  void step(double fractionOfRange, bool dragging);
  void reset();
  QString figure() const;  ///< as shown: "62 %"

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return sizeHint(); }

 signals:
  void changed(double value, bool dragging);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  bool event(QEvent* event) override;

 private:
  double fractionOf(double value) const;
  double valueAt(double fraction) const;
  void setByUser(double value, bool dragging);
  QRectF track() const;

  void openField(const QString& start);
  void closeField(bool take);

  QString m_label, m_icon;
  Range m_range;
  double m_value;
  double m_dragFraction = 0;
  QPointF m_last;
  bool m_pressed = false;
  QLineEdit* m_field = nullptr;
};

}  // namespace alidade
