// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/share_bar.h"

#include <QPainter>

#include "ui/format.h"
#include "ui/theme.h"

namespace alidade {

ShareBar::ShareBar(QWidget* parent) : QWidget(parent) {
  setObjectName(QStringLiteral("shareBar"));
}

void ShareBar::setShares(const std::optional<ElementShares>& shares) {
  m_shares = shares;
  setAccessibleName(words());
  setToolTip(m_shares ? tr("%1 pixels of this element in the picture").arg(m_shares->pixels) : QString());
  update();
}

QString ShareBar::words() const {
  if (!m_shares) return tr("Not in this picture");
  return tr("%1 visible, %2 hidden, %3 unknown")
      .arg(formatPercent(m_shares->visible), formatPercent(m_shares->hidden),
           formatPercent(m_shares->unknown));
}

void ShareBar::paintEvent(QPaintEvent*) {
  QPainter p(this);
  p.setRenderHint(QPainter::Antialiasing);
  const ThemeColours& c = colours();
  if (!m_shares) {
    p.setPen(c.dimText);
    p.drawText(rect(), Qt::AlignLeft | Qt::AlignTop, words());
    return;
  }
  const double all = width() - 1.0;
  const double visible = all * m_shares->visible, hidden = all * m_shares->hidden;
  p.setPen(Qt::NoPen);
  p.setBrush(c.good);
  p.drawRect(QRectF(0, 2, visible, 12));
  p.setBrush(c.line);
  p.drawRect(QRectF(visible, 2, hidden, 12));
  p.setBrush(c.raised);
  p.drawRect(QRectF(visible + hidden, 2, all - visible - hidden, 12));
  p.setBrush(QBrush(c.dimText, Qt::BDiagPattern));
  p.drawRect(QRectF(visible + hidden, 2, all - visible - hidden, 12));
  const QString lines[] = {tr("%1 visible").arg(formatPercent(m_shares->visible)),
                           tr("%1 hidden").arg(formatPercent(m_shares->hidden)),
                           tr("%1 unknown").arg(formatPercent(m_shares->unknown))};
  const QBrush fills[] = {c.good, c.line, QBrush(c.dimText, Qt::BDiagPattern)};
  for (int i = 0; i < 3; ++i) {
    const double y = 20.0 + 15.0 * i;
    p.setPen(QPen(c.dimText, 1));
    p.setBrush(fills[i]);
    p.drawRect(QRectF(0.5, y + 2.5, 9, 9));
    p.setPen(c.text);
    p.drawText(QRectF(16, y, width() - 16, 15), Qt::AlignVCenter | Qt::AlignLeft, lines[i]);
  }
}

}  // namespace alidade
