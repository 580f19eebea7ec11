// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "report/picture_export.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <QFont>
#include <QFontMetricsF>
#include <QImage>
#include <QPainter>
#include <QString>

namespace alidade {

namespace {

constexpr QColor kGround(28, 30, 33);
constexpr QColor kRule(86, 92, 99);
constexpr QColor kLabel(150, 157, 165);
constexpr QColor kText(238, 240, 242);

QFont fontOf(double px, bool bold = false) {
  QFont font("DejaVu Sans");
  font.setPixelSize(std::max(7, static_cast<int>(std::lround(px))));
  font.setBold(bold);
  return font;
}

/// Label and value pairs in the order a reader looks for them; empty values are left out.
std::vector<std::pair<QString, QString>> fieldsOf(const TitleBlock& title) {
  std::vector<std::pair<QString, QString>> fields;
  const auto add = [&](const char* label, const std::string& value) {
    if (!value.empty()) fields.emplace_back(QString::fromUtf8(label), QString::fromStdString(value));
  };
  add("Frame", title.frame);
  add("Time", title.time);
  add("Camera", title.camera);
  add("Pose", title.poseSource);
  add("Position", title.coordinates);
  add("Drawn", title.hidden);
  return fields;
}

/// 1, 2 or 5 times a power of ten, the largest not above `metres`.
double roundLength(double metres) {
  const double power = std::pow(10.0, std::floor(std::log10(metres)));
  for (const double step : {5.0, 2.0})
    if (step * power <= metres) return step * power;
  return power;
}

QString lengthText(double metres) {
  if (metres >= 1.0) return QString::number(metres, 'g', 4) + " m";
  if (metres >= 0.01) return QString::number(metres * 100, 'g', 4) + " cm";
  return QString::number(metres * 1000, 'g', 4) + " mm";
}

void paintScaleBar(QPainter& painter, const TitleBlock& title, const QRectF& area, double unit) {
  const double longest = area.width() * title.metresPerPixelAtCentre;
  if (!(longest > 0) || !std::isfinite(longest)) return;
  const double metres = roundLength(longest);
  const double length = metres / title.metresPerPixelAtCentre;
  const double y = area.top() + unit * 1.9;
  const double left = area.right() - length;
  for (int part = 0; part < 4; ++part) {
    const QRectF block(left + part * length / 4, y, length / 4, unit * 0.45);
    painter.fillRect(block, part % 2 == 0 ? kText : kGround);
  }
  painter.setPen(QPen(kText, std::max(1.0, unit * 0.07)));
  painter.setBrush(Qt::NoBrush);
  painter.drawRect(QRectF(left, y, length, unit * 0.45));
  painter.setFont(fontOf(unit));
  painter.drawText(QRectF(area.left(), area.top(), area.width(), unit * 1.7), Qt::AlignRight | Qt::AlignVCenter,
                   lengthText(metres));
  painter.setPen(kLabel);
  painter.setFont(fontOf(unit * 0.8));
  painter.drawText(QRectF(area.left(), y + unit * 0.7, area.width(), unit * 1.4), Qt::AlignRight | Qt::AlignVCenter,
                   "at " + QString::number(title.scaleDepthM, 'f', 1) + " m from the camera");
}

}  // namespace

ColourImage withTitleBlock(const ColourImage& picture, const TitleBlock& title) {
  const double unit = std::clamp(picture.width() / 95.0, 9.0, 44.0);  // height of the block's body text, px
  const auto fields = fieldsOf(title);
  const int columns = picture.width() > unit * 80 ? 2 : 1;
  const int rows = (static_cast<int>(fields.size()) + columns - 1) / columns;
  const double margin = unit * 1.2;
  const int block = static_cast<int>(std::lround(margin * 2 + unit * 2.2 + rows * unit * 1.7));

  ColourImage result(picture.width(), picture.height() + block);
  std::copy(picture.data(), picture.data() + picture.size(), result.data());
  QImage canvas(reinterpret_cast<uchar*>(result.row(picture.height())), picture.width(), block, picture.width() * 4,
                QImage::Format_RGBA8888);
  canvas.fill(kGround);

  QPainter painter(&canvas);
  painter.setRenderHints(QPainter::Antialiasing | QPainter::TextAntialiasing);
  painter.fillRect(QRectF(0, 0, canvas.width(), std::max(1.0, unit * 0.12)), kRule);

  const double barWidth = title.metresPerPixelAtCentre > 0 ? canvas.width() * 0.2 : unit * 10;
  const double textWidth = canvas.width() - 3 * margin - barWidth;
  painter.setPen(kText);
  const QFont heading = fontOf(unit * 1.35, true);
  painter.setFont(heading);
  painter.drawText(QRectF(margin, margin * 0.8, textWidth, unit * 2),
                   Qt::AlignLeft | Qt::AlignVCenter,
                   QFontMetricsF(heading).elidedText(QString::fromStdString(title.project), Qt::ElideRight, textWidth));

  const QFont body = fontOf(unit);
  const double columnWidth = textWidth / columns;
  const double labelWidth = unit * 5.2;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const double x = margin + columnWidth * static_cast<double>(i / rows);
    const double y = margin + unit * 2.2 + unit * 1.7 * static_cast<double>(i % rows);
    painter.setFont(body);
    painter.setPen(kLabel);
    painter.drawText(QRectF(x, y, labelWidth, unit * 1.6), Qt::AlignLeft | Qt::AlignVCenter, fields[i].first);
    painter.setPen(kText);
    const double width = columnWidth - labelWidth - unit;
    painter.drawText(QRectF(x + labelWidth, y, width, unit * 1.6), Qt::AlignLeft | Qt::AlignVCenter,
                     QFontMetricsF(body).elidedText(fields[i].second, Qt::ElideRight, width));
  }

  const QRectF corner(canvas.width() - margin - barWidth, margin * 0.8, barWidth, block - margin * 1.6);
  if (title.metresPerPixelAtCentre > 0) paintScaleBar(painter, title, corner, unit);
  painter.setPen(kLabel);
  painter.setFont(fontOf(unit * 0.8));
  painter.drawText(corner, Qt::AlignRight | Qt::AlignBottom, QString::fromStdString(title.software));
  painter.end();
  return result;
}

std::map<std::string, std::string> titleText(const TitleBlock& title) {
  std::map<std::string, std::string> text;
  const auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) text[key] = value;
  };
  add("Software", title.software);
  add("Alidade:project", title.project);
  add("Alidade:frame", title.frame);
  add("Alidade:time", title.time);
  add("Alidade:camera", title.camera);
  add("Alidade:pose", title.poseSource);
  add("Alidade:position", title.coordinates);
  add("Alidade:drawn", title.hidden);
  if (title.metresPerPixelAtCentre > 0) {
    add("Alidade:metres_per_pixel", std::to_string(title.metresPerPixelAtCentre));
    add("Alidade:scale_depth_m", std::to_string(title.scaleDepthM));
  }
  return text;
}

}  // namespace alidade
