// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <optional>

#include <QWidget>

#include "cloud/point_summary.h"

namespace alidade {

/// How often each value comes, coloured as the points are, with the two ends of the range to drag.
class HistogramView : public QWidget {
  Q_OBJECT

 public:
  explicit HistogramView(QWidget* parent = nullptr);

  void setHistogram(std::optional<ValueHistogram> histogram, ColourRamp ramp);
  void setRange(double low, double high);

  QSize sizeHint() const override { return {200, 64}; }

 signals:
  void rangeDragged(double low, double high, bool dragging);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;

 private:
  double valueAt(double x) const;
  double xOf(double value) const;

  std::optional<ValueHistogram> m_histogram;
  ColourRamp m_ramp = ColourRamp::Viridis;
  double m_low = 0, m_high = 1;
  int m_grabbed = -1;  ///< 0 the low end, 1 the high end
};

}  // namespace alidade
