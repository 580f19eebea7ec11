// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/settings_form.h"

#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QVBoxLayout>

#include "ui/figure_spin.h"

namespace alidade {

SettingsForm::SettingsForm(Session& session, QWidget* parent) : QScrollArea(parent), m_session(session) {
  setWidgetResizable(true);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* page = new QWidget;
  m_layout = new QVBoxLayout(page);
  m_layout->setContentsMargins(10, 8, 10, 8);
  m_layout->setSpacing(4);
  setWidget(page);
}

QFormLayout* SettingsForm::section(const QString& title) {
  if (m_layout->count() > 0) m_layout->addSpacing(8);
  auto* label = new QLabel(title);
  label->setProperty("role", "heading");
  m_layout->addWidget(label);
  auto* form = new QFormLayout;
  form->setContentsMargins(0, 0, 0, 0);
  form->setHorizontalSpacing(10);
  form->setVerticalSpacing(4);
  form->setLabelAlignment(Qt::AlignLeft);
  m_layout->addLayout(form);
  return form;
}

void SettingsForm::check(QFormLayout* form, const QString& name, const QString& tip,
                         bool DisplaySettings::*member) {
  check(
      form, name, tip, [member](const DisplaySettings& d) { return d.*member; },
      [member](DisplaySettings& d, bool on) { d.*member = on; });
}

void SettingsForm::check(QFormLayout* form, const QString& name, const QString& tip, const GetFlag& get,
                         const SetFlag& set) {
  auto* box = new QCheckBox(name);
  box->setToolTip(tip);
  form->addRow(box);
  connect(box, &QCheckBox::toggled, this,
          [this, set](bool on) { apply([&](DisplaySettings& d) { set(d, on); }); });
  follow([box, get](const DisplaySettings& d) { box->setChecked(get(d)); });
}

void SettingsForm::number(QFormLayout* form, const QString& name, const QString& tip, const QString& unit,
                          double low, double high, double step, int decimals, const Get& get,
                          const Set& set) {
  auto* row = new QWidget;
  auto* layout = new QHBoxLayout(row);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(6);
  auto* slider = new QSlider(Qt::Horizontal);
  constexpr int kSteps = 1000;
  slider->setRange(0, kSteps);
  slider->setMinimumWidth(60);
  auto* spin = new FigureSpin;
  spin->setRange(low, high);
  spin->setSingleStep(step);
  spin->setDecimals(decimals);
  spin->setSuffix(unit);
  spin->setButtonSymbols(QAbstractSpinBox::NoButtons);
  spin->setAlignment(Qt::AlignRight);
  spin->setFixedWidth(78);
  spin->setKeyboardTracking(false);
  row->setToolTip(tip);
  spin->setAccessibleName(name);
  slider->setAccessibleName(name);
  layout->addWidget(slider, 1);
  layout->addWidget(spin);
  form->addRow(name, row);
  connect(slider, &QSlider::valueChanged, this, [this, slider, low, high, set](int at) {
    const double value = low + (high - low) * at / kSteps;
    apply([&](DisplaySettings& d) { set(d, value); }, slider->isSliderDown());
  });
  connect(spin, &QDoubleSpinBox::valueChanged, this,
          [this, set](double value) { apply([&](DisplaySettings& d) { set(d, value); }, false); });
  follow([slider, spin, get, low, high](const DisplaySettings& d) {
    const double value = get(d);
    if (!spin->hasFocus() || std::abs(spin->value() - value) > 0.5 * std::pow(10, -spin->decimals()))
      spin->setValue(value);
    if (!slider->isSliderDown())
      slider->setValue(static_cast<int>(std::lround((value - low) / (high - low) * kSteps)));
  });
}

void SettingsForm::figure(QFormLayout* form, const QString& name, const QString& tip, const QString& unit,
                          double low, double high, double step, int decimals, const Get& get, const Set& set) {
  auto* spin = new FigureSpin;
  spin->setRange(low, high);
  spin->setSingleStep(step);
  spin->setDecimals(decimals);
  spin->setSuffix(unit);
  spin->setAlignment(Qt::AlignRight);
  spin->setMinimumWidth(60);  // wide ranges would ask for more than the panel has
  spin->setKeyboardTracking(false);
  spin->setToolTip(tip);
  spin->setAccessibleName(name);
  form->addRow(name, spin);
  connect(spin, &QDoubleSpinBox::valueChanged, this,
          [this, set](double value) { apply([&](DisplaySettings& d) { set(d, value); }); });
  follow([spin, get](const DisplaySettings& d) { spin->setValue(get(d)); });
}

void SettingsForm::choice(QFormLayout* form, const QString& name, const QString& tip,
                          const QStringList& names, const Get& get, const Set& set) {
  auto* box = new QComboBox;
  box->addItems(names);
  box->setToolTip(tip);
  box->setAccessibleName(name);
  form->addRow(name, box);
  connect(box, &QComboBox::currentIndexChanged, this,
          [this, set](int index) { apply([&](DisplaySettings& d) { set(d, index); }, false); });
  follow(
      [box, get](const DisplaySettings& d) { box->setCurrentIndex(static_cast<int>(get(d))); });
}

void SettingsForm::follow(std::function<void(const DisplaySettings&)> refresher) {
  m_refreshers.push_back(std::move(refresher));
}

void SettingsForm::apply(const std::function<void(DisplaySettings&)>& edit, bool dragging) {
  if (m_refreshing) return;
  DisplaySettings display = m_session.display();
  edit(display);
  m_session.setDisplay(display, dragging);
}

void SettingsForm::finish() {
  m_layout->addStretch(1);
  connect(&m_session, &Session::displayChanged, this, &SettingsForm::refresh);
  refresh();
}

void SettingsForm::refresh() {
  m_refreshing = true;
  for (const auto& refresher : m_refreshers) refresher(m_session.display());
  m_refreshing = false;
}

}  // namespace alidade
