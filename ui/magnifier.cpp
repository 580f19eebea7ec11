// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include <QImage>
#include <QPainter>
#include <QPainterPath>

#include "ui/format.h"
#include "ui/overlay_view.h"
#include "ui/theme.h"
#include "ui/view_tool.h"

namespace alidade {

namespace {

constexpr double kSide = 168.0;      // of the square, screen pixels
constexpr double kProfile = 46.0;    // height of the depth profile below it
constexpr double kSpanRawPx = 21.0;  // raw pixels across the square at zoom 1

QRectF placeBeside(const OverlayView& view, const QPointF& cursor) {
  QRectF box(cursor + QPointF(28, 28), QSizeF(kSide, kSide + kProfile));
  if (box.right() > view.width() - 8) box.moveRight(cursor.x() - 28);
  if (box.bottom() > view.height() - 8) box.moveBottom(cursor.y() - 28);
  box.moveLeft(std::max(8.0, box.left()));
  box.moveTop(std::max(8.0, box.top()));
  return box;
}

void paintProfile(OverlayView& view, QPainter& painter, const QRectF& area, const glm::dvec2& raw,
                  double span) {
  painter.fillRect(area, QColor(24, 24, 24));
  constexpr int kSteps = 84;
  std::vector<double> depth(kSteps);
  double low = 1e300, high = -1e300;
  for (int i = 0; i < kSteps; ++i) {
    depth[static_cast<std::size_t>(i)] =
        view.probe().scanDepth(raw + glm::dvec2((i + 0.5) / kSteps * span - span / 2, 0));
    if (!std::isfinite(depth[static_cast<std::size_t>(i)])) continue;
    low = std::min(low, depth[static_cast<std::size_t>(i)]);
    high = std::max(high, depth[static_cast<std::size_t>(i)]);
  }
  painter.setFont(smallFont());
  if (low > high) {
    painter.setPen(QColor(200, 200, 200));
    painter.drawText(area, Qt::AlignCenter, OverlayView::tr("No scan here"));
    return;
  }
  const double range = std::max(high - low, 0.05);
  const auto y = [&](double d) { return area.top() + 5 + (d - low) / range * (area.height() - 20); };
  QPainterPath path;
  bool open = false;
  for (int i = 0; i < kSteps; ++i) {
    const double d = depth[static_cast<std::size_t>(i)];
    if (!std::isfinite(d)) {
      open = false;
      continue;
    }
    const QPointF p(area.left() + (i + 0.5) / kSteps * area.width(), y(d));
    open ? path.lineTo(p) : path.moveTo(p);
    open = true;
  }
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(QColor(255, 200, 60), 1.4));
  painter.drawPath(path);
  painter.setPen(QColor(255, 255, 255, 70));
  painter.drawLine(QPointF(area.center().x(), area.top()), QPointF(area.center().x(), area.bottom()));
  painter.setPen(QColor(220, 220, 220));
  painter.drawText(area.adjusted(5, 0, -5, -1), Qt::AlignBottom | Qt::AlignLeft, formatDistance(low));
  painter.drawText(area.adjusted(5, 0, -5, -1), Qt::AlignBottom | Qt::AlignRight,
                   OverlayView::tr("Δ %1").arg(formatMillimetres(high - low)));
}

}  // namespace

void paintMagnifier(OverlayView& view, QPainter& painter) {
  const auto raw = view.cursorRaw();
  const ColourImage* picture = view.probe().rawPicture();
  if (!raw || !picture || picture->empty()) return;
  const QRectF box = placeBeside(view, view.viewFromRaw(*raw));
  const QRectF square(box.topLeft(), QSizeF(kSide, kSide));
  const double span = std::clamp(kSpanRawPx / std::max(view.zoom(), 0.05) * 0.6, 9.0, 61.0);

  painter.save();
  painter.setRenderHint(QPainter::SmoothPixmapTransform, false);
  painter.fillRect(square, Qt::black);
  const int left = static_cast<int>(std::floor(raw->x - span / 2)),
            top = static_cast<int>(std::floor(raw->y - span / 2));
  const int count = static_cast<int>(std::ceil(span)) + 2;
  QImage cut(count, count, QImage::Format_RGB32);
  cut.fill(Qt::black);
  for (int y = 0; y < count; ++y)
    for (int x = 0; x < count; ++x)
      if (picture->contains(left + x, top + y)) {
        const Rgba8 c = picture->at(left + x, top + y);
        cut.setPixel(x, y, qRgb(c.r, c.g, c.b));
      }
  const double cell = kSide / span;
  const QPointF origin = square.center() - QPointF((raw->x - left + 0.5) * cell, (raw->y - top + 0.5) * cell);
  painter.setClipRect(square);
  painter.drawImage(QRectF(origin, QSizeF(count * cell, count * cell)), cut);
  painter.setClipping(false);
  const QPointF c = square.center();
  drawCasedLine(painter, c - QPointF(22, 0), c - QPointF(4, 0), Qt::white, 1.2);
  drawCasedLine(painter, c + QPointF(4, 0), c + QPointF(22, 0), Qt::white, 1.2);
  drawCasedLine(painter, c - QPointF(0, 22), c - QPointF(0, 4), Qt::white, 1.2);
  drawCasedLine(painter, c + QPointF(0, 4), c + QPointF(0, 22), Qt::white, 1.2);
  paintProfile(view, painter, QRectF(square.bottomLeft(), QSizeF(kSide, kProfile)), *raw, span);
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(QColor(0, 0, 0, 160), 3));
  painter.drawRect(box);
  painter.setPen(QPen(QColor(235, 235, 235), 1));
  painter.drawRect(box);
  painter.restore();
}

void paintDistances(OverlayView& view, QPainter& painter, const MeasuredDistances& measurements) {
  painter.setFont(bodyFont());
  const QColor fill(120, 230, 255);
  for (const MeasuredDistance& m : measurements) {
    const auto a = view.probe().project(m.from), b = view.probe().project(m.to);
    if (!a || !b) continue;
    const QPointF pa = view.viewFromRaw(*a), pb = view.viewFromRaw(*b);
    drawCasedLine(painter, pa, pb, fill);
    for (const QPointF& p : {pa, pb}) {
      painter.setBrush(fill);
      painter.setPen(QPen(QColor(0, 0, 0, 200), 1.5));
      painter.drawEllipse(p, 4, 4);
    }
    const glm::dvec3 d = m.to - m.from;
    QString words = QStringLiteral("%1 m").arg(glm::length(d), 0, 'f', 3);
    if (m.uncertaintyM) words += QStringLiteral(" ± %1").arg(formatMillimetres(*m.uncertaintyM));
    const QString parts = QStringLiteral("ΔE %1  ΔN %2  ΔH %3 m")
                              .arg(formatCoordinate(d.x), formatCoordinate(d.y), formatCoordinate(d.z));
    const QPointF at = (pa + pb) / 2 + QPointF(8, -8);
    drawCasedText(painter, at, words, Qt::white);
    drawCasedText(painter, at + QPointF(0, 17), parts, QColor(225, 240, 245));
  }
}

}  // namespace alidade
