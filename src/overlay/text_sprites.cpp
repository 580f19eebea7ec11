// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/text_sprites.h"

#include <cmath>

#include <QFontMetricsF>
#include <QPainter>
#include <QPainterPath>

namespace alidade {

namespace {

const QColor kCasing(10, 14, 20, 205);
constexpr double kCasingPx = 3.6;
constexpr std::size_t kMostSprites = 512;

TextSprites::Sprite draw(const TextBlock& block, const QFont& font, const QColor& colour, double scale) {
  TextSprites::Sprite sprite;
  sprite.margin = static_cast<int>(std::ceil(kCasingPx / 2 * scale));
  sprite.image = QImage(static_cast<int>(std::ceil(block.size.width())) + 2 * sprite.margin,
                        static_cast<int>(std::ceil(block.size.height())) + 2 * sprite.margin, QImage::Format_RGBA8888_Premultiplied);
  sprite.image.fill(Qt::transparent);
  QPainter paint(&sprite.image);
  paint.setRenderHint(QPainter::Antialiasing);
  const QFontMetricsF metrics(font);
  QPainterPath path;
  double y = sprite.margin + block.padding + metrics.ascent();
  for (const QString& line : block.lines) {
    path.addText(QPointF(sprite.margin + block.padding, y), font, line);
    y += metrics.height();
  }
  paint.setBrush(Qt::NoBrush);
  paint.setPen(QPen(kCasing, kCasingPx * scale, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  paint.drawPath(path);
  paint.fillPath(path, colour);
  return sprite;
}

}  // namespace

const TextSprites::Sprite& TextSprites::of(const TextBlock& block, const QFont& font, const QColor& colour, double scale) {
  const Key key(block.lines.join(QLatin1Char('\n')), font.key(), colour.rgba(), scale);
  if (const auto it = m_sprites.find(key); it != m_sprites.end()) return it->second;
  if (m_sprites.size() >= kMostSprites) m_sprites.clear();
  return m_sprites.emplace(key, draw(block, font, colour, scale)).first->second;
}

}  // namespace alidade
