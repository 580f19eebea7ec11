// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/theme_style.h"

#include <algorithm>

#include <QPainter>
#include <QStyleFactory>
#include <QStyleOption>

#include "ui/theme.h"

namespace alidade {

ThemeStyle::ThemeStyle() : QProxyStyle(QStyleFactory::create(QStringLiteral("Fusion"))) {}

void ThemeStyle::drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                               const QWidget* widget) const {
  if (element != PE_IndicatorCheckBox && element != PE_IndicatorItemViewItemCheck) {
    QProxyStyle::drawPrimitive(element, option, painter, widget);
    return;
  }
  const ThemeColours& c = colours();
  const bool enabled = option->state & State_Enabled;
  const int side = std::min(option->rect.width(), option->rect.height());
  QRectF box(0, 0, side - 1, side - 1);
  box.moveCenter(QRectF(option->rect).center());
  painter->save();
  painter->setRenderHint(QPainter::Antialiasing);
  painter->setPen(QPen(option->state & State_HasFocus ? c.accent : c.dimText, 1));
  painter->setBrush(c.ground);
  painter->drawRoundedRect(box, 2, 2);
  painter->setPen(QPen(enabled ? c.text : c.dimText, side / 7.0, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  const auto at = [&](double x, double y) {
    return box.topLeft() + QPointF(x * box.width(), y * box.height());
  };
  if (option->state & State_On)
    painter->drawPolyline(QPolygonF({at(0.24, 0.52), at(0.44, 0.73), at(0.78, 0.28)}));
  else if (option->state & State_NoChange)
    painter->drawLine(at(0.26, 0.5), at(0.74, 0.5));
  painter->restore();
}

}  // namespace alidade
