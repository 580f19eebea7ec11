// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/figure_spin.h"

#include "ui/format.h"

namespace alidade {

namespace {

QString withHyphen(QString text) {
  return text.replace(kMinus, '-');
}

}  // namespace

QString FigureSpin::textFromValue(double value) const {
  return withMinus(QDoubleSpinBox::textFromValue(value));
}

double FigureSpin::valueFromText(const QString& text) const {
  return QDoubleSpinBox::valueFromText(withHyphen(text));
}

QValidator::State FigureSpin::validate(QString& text, int& position) const {
  QString plain = withHyphen(text);
  const QValidator::State state = QDoubleSpinBox::validate(plain, position);
  text = withMinus(plain);
  return state;
}

}  // namespace alidade
