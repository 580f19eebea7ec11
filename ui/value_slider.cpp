// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/value_slider.h"

#include <algorithm>
#include <cmath>

#include <QKeyEvent>
#include <QLineEdit>
#include <QLocale>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>

#include "ui/theme.h"

namespace alidade {

namespace {

constexpr int kIconWidth = 22;
constexpr int kTrackWidth = 110;
constexpr int kFigureWidth = 52;

}  // namespace

ValueSlider::ValueSlider(const QString& label, const QString& iconName, const Range& range, QWidget* parent)
    : QWidget(parent), m_label(label), m_icon(iconName), m_range(range), m_value(range.automatic) {
  setFocusPolicy(Qt::StrongFocus);
  setCursor(Qt::SizeHorCursor);
  setAccessibleName(label);
  setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
}

QSize ValueSlider::sizeHint() const {
  const int label = fontMetrics().horizontalAdvance(m_label) + 8;
  return {kIconWidth + label + kTrackWidth + 8 + kFigureWidth, 30};
}

QRectF ValueSlider::track() const {
  const double left = width() - kFigureWidth - kTrackWidth - 4.0;
  return {left, height() / 2.0 - 2.0, static_cast<double>(kTrackWidth), 4.0};
}

double ValueSlider::fractionOf(double value) const {
  if (m_range.logarithmic) return std::log(value / m_range.low) / std::log(m_range.high / m_range.low);
  return (value - m_range.low) / (m_range.high - m_range.low);
}

double ValueSlider::valueAt(double fraction) const {
  const double f = std::clamp(fraction, 0.0, 1.0);
  if (m_range.logarithmic) return m_range.low * std::pow(m_range.high / m_range.low, f);
  return m_range.low + f * (m_range.high - m_range.low);
}

void ValueSlider::setValue(double value) {
  value = std::clamp(value, m_range.low, m_range.high);
  if (value == m_value) return;
  m_value = value;
  update();
}

void ValueSlider::setByUser(double value, bool dragging) {
  value = std::clamp(value, m_range.low, m_range.high);
  if (value == m_value && dragging) return;
  m_value = value;
  update();
  emit changed(value, dragging);
}

void ValueSlider::step(double fractionOfRange, bool dragging) {
  setByUser(valueAt(fractionOf(m_value) + fractionOfRange), dragging);
}

void ValueSlider::reset() {
  setByUser(m_range.automatic, false);
}

QString ValueSlider::figure() const {
  return QStringLiteral("%1 %2")
      .arg(m_value * m_range.displayFactor, 0, 'f', m_range.decimals)
      .arg(m_range.unit);
}

void ValueSlider::paintEvent(QPaintEvent*) {
  QPainter p(this);
  p.setRenderHint(QPainter::Antialiasing);
  const ThemeColours& c = colours();
  icon(m_icon).paint(&p, QRect(3, (height() - 16) / 2, 16, 16));
  const QRectF bar = track();
  p.setPen(c.text);
  p.drawText(QRectF(kIconWidth, 0, bar.left() - kIconWidth - 6, height()), Qt::AlignVCenter | Qt::AlignLeft,
             m_label);
  p.setPen(Qt::NoPen);
  p.setBrush(c.line);
  p.drawRoundedRect(bar, 2, 2);
  const double x = bar.left() + bar.width() * std::clamp(fractionOf(m_value), 0.0, 1.0);
  p.setBrush(isEnabled() ? c.accent : c.dimText);
  p.drawRoundedRect(QRectF(bar.left(), bar.top(), x - bar.left(), bar.height()), 2, 2);
  // The tick under the bar is where automatic stands.
  const double tick = bar.left() + bar.width() * std::clamp(fractionOf(m_range.automatic), 0.0, 1.0);
  p.setBrush(c.dimText);
  p.drawRect(QRectF(tick - 0.5, bar.bottom() + 4, 1, 4));
  p.setBrush(m_pressed || hasFocus() ? c.accent : c.text);
  p.drawEllipse(QPointF(x, bar.center().y()), 6, 6);
  p.setPen(c.text);
  p.drawText(QRectF(width() - kFigureWidth + 4, 0, kFigureWidth - 6, height()),
             Qt::AlignVCenter | Qt::AlignRight, figure());
}

void ValueSlider::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton) return;
  if (event->position().x() > width() - kFigureWidth) {
    openField(QString());
    return;
  }
  m_pressed = true;
  m_dragFraction = fractionOf(m_value);
  m_last = event->position();
  update();
}

void ValueSlider::mouseMoveEvent(QMouseEvent* event) {
  if (!m_pressed) return;
  const double slow = event->modifiers() & Qt::ShiftModifier ? 0.1 : 1.0;
  m_dragFraction += (event->position().x() - m_last.x()) / kTrackWidth * slow;
  m_last = event->position();
  setByUser(valueAt(m_dragFraction), true);
}

void ValueSlider::mouseReleaseEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton || !m_pressed) return;
  m_pressed = false;
  update();
  emit changed(m_value, false);
}

void ValueSlider::mouseDoubleClickEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton && event->position().x() <= width() - kFigureWidth) reset();
}

void ValueSlider::wheelEvent(QWheelEvent* event) {
  const double slow = event->modifiers() & Qt::ShiftModifier ? 0.1 : 1.0;
  const QPoint angle = event->angleDelta();
  const int turn = angle.y() != 0 ? angle.y() : angle.x();  // Shift turns the wheel sideways
  step(turn / 120.0 * 0.04 * slow, true);
  event->accept();
}

void ValueSlider::keyPressEvent(QKeyEvent* event) {
  const double size = event->modifiers() & Qt::ShiftModifier ? 0.005 : 0.05;
  switch (event->key()) {
    case Qt::Key_Left:
    case Qt::Key_Down:
      step(-size, false);
      return;
    case Qt::Key_Right:
    case Qt::Key_Up:
      step(size, false);
      return;
    case Qt::Key_Home:
      setByUser(m_range.low, false);
      return;
    case Qt::Key_End:
      setByUser(m_range.high, false);
      return;
    case Qt::Key_Return:
    case Qt::Key_Enter:
      openField(QString());
      return;
    default:
      break;
  }
  const QString typed = event->text();
  if (!typed.isEmpty() && (typed[0].isDigit() || typed[0] == '.')) {
    openField(typed);
    return;
  }
  QWidget::keyPressEvent(event);
}

bool ValueSlider::event(QEvent* event) {
  if (event->type() == QEvent::ShortcutOverride) {
    // These keys mean this slider while it has the focus, not a frame step or a pass.
    auto* key = static_cast<QKeyEvent*>(event);
    const bool digit = !key->text().isEmpty() && (key->text()[0].isDigit() || key->text()[0] == '.');
    const bool plain = !(key->modifiers() & (Qt::ControlModifier | Qt::AltModifier));
    const int k = key->key();
    const bool mine = k == Qt::Key_Left || k == Qt::Key_Right || k == Qt::Key_Up || k == Qt::Key_Down ||
                      k == Qt::Key_Home || k == Qt::Key_End;
    if (plain && (mine || digit)) {
      event->accept();
      return true;
    }
  }
  return QWidget::event(event);
}

void ValueSlider::openField(const QString& start) {
  if (m_field) return;
  m_field = new QLineEdit(this);
  m_field->setAlignment(Qt::AlignRight);
  m_field->setGeometry(width() - kFigureWidth, 2, kFigureWidth, height() - 4);
  m_field->setStyleSheet(QStringLiteral("padding: 0 3px;"));
  if (start.isEmpty()) {
    m_field->setText(QString::number(m_value * m_range.displayFactor, 'f', m_range.decimals));
    m_field->selectAll();
  } else {
    m_field->setText(start);
  }
  m_field->show();
  m_field->setFocus();
  connect(m_field, &QLineEdit::editingFinished, this, [this] { closeField(true); });
}

void ValueSlider::closeField(bool take) {
  if (!m_field) return;
  QLineEdit* field = std::exchange(m_field, nullptr);
  bool ok = false;
  QString typed = field->text();
  const double number = typed.replace(',', '.').toDouble(&ok);
  const bool hadFocus = field->hasFocus();
  field->deleteLater();
  if (hadFocus) setFocus();
  if (take && ok && std::isfinite(number)) setByUser(number / m_range.displayFactor, false);
}

}  // namespace alidade
