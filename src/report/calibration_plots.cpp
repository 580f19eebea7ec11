// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/calibration_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <QFont>
#include <QImage>
#include <QPainter>
#include <QPainterPath>
#include <QString>

namespace alidade {

namespace {

constexpr int kColumns = 16, kRows = 12;

struct Colours {
  QColor ground, frame, text, single, mean, outlier, cell;
};

Colours coloursOf(PlotGround ground) {
  if (ground == PlotGround::Paper)
    return {QColor(255, 255, 255), QColor(120, 126, 133), QColor(30, 33, 37), QColor(0, 90, 160, 110), QColor(190, 70, 0),
            QColor(200, 0, 60), QColor(0, 114, 178)};
  return {QColor(32, 34, 37), QColor(110, 116, 123), QColor(220, 223, 226), QColor(110, 180, 235, 130), QColor(255, 165, 60),
          QColor(255, 90, 120), QColor(86, 180, 233)};
}

/// 1, 2 or 5 times a power of ten, the largest not above `value`.
double roundBelow(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  return value >= 5 * power ? 5 * power : value >= 2 * power ? 2 * power : power;
}

class Plotter {
 public:
  Plotter(QPainter& painter, const QRectF& area, const CalibrationSummary& summary, PlotGround ground)
      : m_painter(painter), m_area(area), m_summary(summary), m_colours(coloursOf(ground)), m_unit(area.width() / 60) {
    painter.fillRect(area, m_colours.ground);
    QFont font(QStringLiteral("DejaVu Sans"));
    font.setPixelSize(std::max(7, static_cast<int>(std::lround(1.15 * m_unit))));
    painter.setFont(font);
    painter.setRenderHints(QPainter::Antialiasing | QPainter::TextAntialiasing);
  }

  void residuals();
  void radial();
  void coverage();

 private:
  void layPicture();
  QPointF at(const glm::dvec2& pixel) const {
    return {m_frame.left() + (pixel.x + 0.5) * m_scale, m_frame.top() + (pixel.y + 0.5) * m_scale};
  }
  void caption(const QString& text) {
    m_painter.setPen(m_colours.text);
    m_painter.drawText(QRectF(m_area.left() + m_unit, m_area.bottom() - 2.2 * m_unit, m_area.width() - 2 * m_unit, 2 * m_unit),
                       Qt::AlignLeft | Qt::AlignVCenter, text);
  }
  void line(const QPointF& from, const QPointF& to, const QColor& colour, double width) {
    m_painter.setPen(QPen(colour, width * m_unit, Qt::SolidLine, Qt::RoundCap));
    m_painter.drawLine(from, to);
  }
  void arrow(const QPointF& from, const QPointF& to);

  QPainter& m_painter;
  const QRectF m_area;
  const CalibrationSummary& m_summary;
  const Colours m_colours;
  const double m_unit;
  QRectF m_frame;      ///< of the picture
  double m_scale = 1;  ///< plot units a picture pixel
};

void Plotter::layPicture() {
  const Intrinsics& in = m_summary.intrinsics;
  const QRectF room = m_area.adjusted(m_unit, m_unit, -m_unit, -2.6 * m_unit);
  m_scale = std::min(room.width() / in.width, room.height() / in.height);
  m_frame = QRectF(0, 0, in.width * m_scale, in.height * m_scale);
  m_frame.moveCenter(room.center());
  m_painter.setPen(QPen(m_colours.frame, 0.12 * m_unit));
  m_painter.setBrush(Qt::NoBrush);
  m_painter.drawRect(m_frame);
}

void Plotter::arrow(const QPointF& from, const QPointF& to) {
  line(from, to, m_colours.mean, 0.22);
  const QPointF way = to - from;
  const double length = std::hypot(way.x(), way.y());
  if (length < 0.5 * m_unit) return;
  const QPointF along = way / length * 0.6 * m_unit, across(-along.y() * 0.5, along.x() * 0.5);
  line(to, to - along + across, m_colours.mean, 0.22);
  line(to, to - along - across, m_colours.mean, 0.22);
}

void Plotter::residuals() {
  layPicture();
  // A residual of the rms is as long as a twentieth of the picture is wide: the factor is a round number.
  const double factor = roundBelow(std::max(1.0, m_summary.intrinsics.width / (25 * std::max(1e-6, m_summary.rmsPx))));
  struct Cell { glm::dvec2 place{0}, sum{0}; int count = 0; };
  std::array<Cell, kColumns * kRows> cells;
  m_painter.setClipRect(m_frame);
  for (const CalibrationResidual& r : m_summary.residuals) {
    if (!std::isfinite(r.residualPx.x)) continue;
    line(at(r.pixel), at(r.pixel + factor * r.residualPx), r.outlier ? m_colours.outlier : m_colours.single, 0.08);
    if (r.outlier) continue;
    const int c = std::clamp(static_cast<int>((r.pixel.x + 0.5) / m_summary.intrinsics.width * kColumns), 0, kColumns - 1);
    const int w = std::clamp(static_cast<int>((r.pixel.y + 0.5) / m_summary.intrinsics.height * kRows), 0, kRows - 1);
    Cell& cell = cells[w * kColumns + c];
    cell.place += r.pixel, cell.sum += r.residualPx, ++cell.count;
  }
  constexpr int enough = 4;
  for (const Cell& cell : cells)
    if (cell.count >= enough) {
      const double n = cell.count;
      arrow(at(cell.place / n), at((cell.place + factor * cell.sum) / n));
    }
  m_painter.setClipping(false);
  // The scale: what a bar of a few units of length stands for.
  const double px = roundBelow(12 * m_unit / (m_scale * factor));
  const QPointF right(m_frame.right(), m_area.bottom() - 1.2 * m_unit), left = right - QPointF(px * factor * m_scale, 0);
  line(left, right, m_colours.text, 0.3);
  m_painter.setPen(m_colours.text);
  m_painter.drawText(QRectF(left.x() - 8.5 * m_unit, left.y() - m_unit, 8 * m_unit, 2 * m_unit), Qt::AlignRight | Qt::AlignVCenter,
                     QStringLiteral("%1 px").arg(px));
  caption(QStringLiteral("Residuals × %1; arrows: mean of a cell").arg(factor));
}

void Plotter::radial() {
  const Intrinsics& in = m_summary.intrinsics;
  const QRectF plot = m_area.adjusted(6 * m_unit, m_unit, -1.5 * m_unit, -5 * m_unit);
  const glm::dvec2 centre(in.cx, in.cy);
  double farthest = 1;
  for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(in.width, 0), glm::dvec2(0, in.height), glm::dvec2(in.width, in.height)})
    farthest = std::max(farthest, glm::length(corner - centre));
  const double highest = 4 * std::max(1e-6, m_summary.sigmaPx);
  const auto place = [&](double radius, double residual) {
    return QPointF(plot.left() + plot.width() * radius / farthest,
                   plot.center().y() - 0.5 * plot.height() * std::clamp(residual / highest, -1.0, 1.0));
  };
  m_painter.setPen(QPen(m_colours.frame, 0.12 * m_unit));
  m_painter.setBrush(Qt::NoBrush);
  m_painter.drawRect(plot);
  line(place(0, 0), place(farthest, 0), m_colours.frame, 0.1);
  constexpr int rings = 16;
  struct Ring { double sum = 0, squares = 0; int count = 0; };
  std::array<Ring, rings> ring;
  m_painter.setPen(Qt::NoPen);
  for (const CalibrationResidual& r : m_summary.residuals) {
    const double radius = glm::length(r.pixel - centre);
    if (!(radius > 0) || !std::isfinite(r.residualPx.x)) continue;
    const double along = glm::dot(r.residualPx, (r.pixel - centre) / radius);
    m_painter.setBrush(r.outlier ? m_colours.outlier : m_colours.single);
    m_painter.drawEllipse(place(radius, along), 0.22 * m_unit, 0.22 * m_unit);
    if (r.outlier) continue;
    Ring& into = ring[std::min(rings - 1, static_cast<int>(radius / farthest * rings))];
    into.sum += along, into.squares += along * along, ++into.count;
  }
  QPainterPath means;
  for (int i = 0; i < rings; ++i) {
    constexpr int enough = 5;
    if (ring[i].count < enough) continue;
    const double n = ring[i].count, mean = ring[i].sum / n, radius = (i + 0.5) / rings * farthest;
    const double std = std::sqrt(std::max(0.0, ring[i].squares / n - mean * mean) / n);
    if (means.elementCount() == 0) means.moveTo(place(radius, mean));
    else means.lineTo(place(radius, mean));
    line(place(radius, mean - 2 * std), place(radius, mean + 2 * std), m_colours.mean, 0.18);
  }
  m_painter.setBrush(Qt::NoBrush);
  m_painter.setPen(QPen(m_colours.mean, 0.25 * m_unit));
  m_painter.drawPath(means);
  m_painter.setPen(m_colours.text);
  for (const double residual : {-highest, -0.5 * highest, 0.0, 0.5 * highest, highest})
    m_painter.drawText(QRectF(m_area.left(), place(0, residual).y() - m_unit, 5.5 * m_unit, 2 * m_unit), Qt::AlignRight | Qt::AlignVCenter,
                       QStringLiteral("%1").arg(residual, 0, 'g', 2));
  const double step = roundBelow(0.34 * farthest);
  for (double radius = 0; radius <= farthest; radius += step)
    m_painter.drawText(QRectF(place(radius, 0).x() - 4 * m_unit, plot.bottom() + 0.2 * m_unit, 8 * m_unit, 2 * m_unit),
                       Qt::AlignHCenter | Qt::AlignVCenter, QStringLiteral("%1").arg(radius, 0, 'f', 0));
  caption(QStringLiteral("Radial residual, px, over the distance from the principal point, px; line: mean of a ring ± 2 std"));
}

void Plotter::coverage() {
  layPicture();
  std::array<int, kColumns * kRows> counts{};
  const Intrinsics& in = m_summary.intrinsics;
  for (const CalibrationResidual& r : m_summary.residuals)
    ++counts[std::clamp(static_cast<int>((r.pixel.y + 0.5) / in.height * kRows), 0, kRows - 1) * kColumns +
             std::clamp(static_cast<int>((r.pixel.x + 0.5) / in.width * kColumns), 0, kColumns - 1)];
  const int most = std::max(1, *std::max_element(counts.begin(), counts.end()));
  const double w = m_frame.width() / kColumns, h = m_frame.height() / kRows;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const QRectF cell(m_frame.left() + i % kColumns * w, m_frame.top() + i / kColumns * h, w, h);
    QColor fill = m_colours.cell;
    fill.setAlphaF(counts[i] == 0 ? 0.0 : 0.12 + 0.75 * std::sqrt(static_cast<double>(counts[i]) / most));
    m_painter.fillRect(cell, fill);
    m_painter.setPen(counts[i] == 0 ? m_colours.outlier : m_colours.text);
    m_painter.drawText(cell, Qt::AlignCenter, QString::number(counts[i]));
  }
  m_painter.setPen(QPen(m_colours.frame, 0.12 * m_unit));
  m_painter.setBrush(Qt::NoBrush);
  m_painter.drawRect(m_frame);
  caption(QStringLiteral("Corners in each cell of the picture"));
}

}  // namespace

void paintCalibrationPlot(QPainter& painter, const QRectF& area, CalibrationPlot plot, const CalibrationSummary& summary,
                          PlotGround ground) {
  painter.save();
  Plotter plotter(painter, area, summary, ground);
  switch (plot) {
    case CalibrationPlot::Residuals: plotter.residuals(); break;
    case CalibrationPlot::Radial: plotter.radial(); break;
    case CalibrationPlot::Coverage: plotter.coverage(); break;
  }
  painter.restore();
}

ColourImage calibrationPicture(CalibrationPlot plot, const CalibrationSummary& summary, int width, int height, PlotGround ground) {
  ColourImage image(std::max(1, width), std::max(1, height));
  QImage canvas(reinterpret_cast<uchar*>(image.data()), image.width(), image.height(), image.width() * 4, QImage::Format_RGBA8888);
  QPainter painter(&canvas);
  paintCalibrationPlot(painter, QRectF(0, 0, image.width(), image.height()), plot, summary, ground);
  return image;
}

}  // namespace alidade
