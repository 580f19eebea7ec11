// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/histogram_view.h"

#include <algorithm>
#include <cmath>

#include <QMouseEvent>
#include <QPainter>

#include "cloud/colour_ramp.h"

namespace alidade {

namespace {

constexpr double kMargin = 5;

QColor colourOf(ColourRamp ramp, double share) {
  const glm::u8vec3 c = rampColour(ramp, share);
  return {c.r, c.g, c.b};
}

}  // namespace

HistogramView::HistogramView(QWidget* parent) : QWidget(parent) {
  setObjectName(QStringLiteral("histogram"));
  setMinimumHeight(56);
  setCursor(Qt::SizeHorCursor);
  setToolTip(tr("How often each value comes. Drag the ends of the range"));
}

void HistogramView::setHistogram(std::optional<ValueHistogram> histogram, ColourRamp ramp) {
  m_histogram = std::move(histogram);
  m_ramp = ramp;
  setVisible(m_histogram.has_value());
  update();
}

void HistogramView::setRange(double low, double high) {
  m_low = low;
  m_high = high;
  update();
}

double HistogramView::valueAt(double x) const {
  const double share = std::clamp((x - kMargin) / std::max(1.0, width() - 2 * kMargin), 0.0, 1.0);
  return m_histogram->low + share * (m_histogram->high - m_histogram->low);
}

double HistogramView::xOf(double value) const {
  const double span = std::max(m_histogram->high - m_histogram->low, 1e-12);
  return kMargin + std::clamp((value - m_histogram->low) / span, 0.0, 1.0) * (width() - 2 * kMargin);
}

void HistogramView::paintEvent(QPaintEvent*) {
  if (!m_histogram) return;
  QPainter painter(this);
  const auto& counts = m_histogram->counts;
  // The root keeps rare values visible beside a peak.
  const double most = std::sqrt(static_cast<double>(std::max(1u, *std::max_element(counts.begin(), counts.end()))));
  const double bin = (width() - 2 * kMargin) / static_cast<double>(counts.size()), floor = height() - 4.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double x = kMargin + bin * static_cast<double>(i), value = valueAt(x + 0.5 * bin);
    const double tall = counts[i] == 0 ? 0 : std::max(1.0, (floor - 4) * std::sqrt(counts[i]) / most);
    const double share = (value - m_low) / std::max(m_high - m_low, 1e-12);
    painter.fillRect(QRectF(x, floor - tall, std::max(1.0, bin), tall), colourOf(m_ramp, std::clamp(share, 0.0, 1.0)));
  }
  painter.setPen(palette().color(QPalette::Mid));
  painter.drawLine(QPointF(kMargin, floor + 0.5), QPointF(width() - kMargin, floor + 0.5));
  painter.setRenderHint(QPainter::Antialiasing);
  for (const double value : {m_low, m_high}) {
    const double x = xOf(value);
    painter.setPen(QPen(palette().color(QPalette::WindowText), 1.5));
    painter.drawLine(QPointF(x, 2), QPointF(x, height() - 2));
    painter.setBrush(palette().color(QPalette::WindowText));
    painter.setPen(Qt::NoPen);
    painter.drawEllipse(QPointF(x, height() - 4), 3.5, 3.5);
  }
}

void HistogramView::mousePressEvent(QMouseEvent* event) {
  if (!m_histogram || event->button() != Qt::LeftButton) return;
  const double x = event->position().x();
  m_grabbed = std::abs(x - xOf(m_low)) <= std::abs(x - xOf(m_high)) ? 0 : 1;
  mouseMoveEvent(event);
}

void HistogramView::mouseMoveEvent(QMouseEvent* event) {
  if (m_grabbed < 0) return;
  const double value = valueAt(event->position().x());
  (m_grabbed == 0 ? m_low : m_high) = value;
  if (m_low > m_high) {
    std::swap(m_low, m_high);
    m_grabbed = 1 - m_grabbed;
  }
  update();
  emit rangeDragged(m_low, m_high, true);
}

void HistogramView::mouseReleaseEvent(QMouseEvent*) {
  if (m_grabbed < 0) return;
  m_grabbed = -1;
  emit rangeDragged(m_low, m_high, false);
}

}  // namespace alidade
