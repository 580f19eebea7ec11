// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/display_panel.h"

#include <algorithm>
#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QSlider>
#include <QVBoxLayout>

#include "geometry/angle.h"

namespace alidade {

LightAngles lightAngles(const glm::dvec3& travel) {
  const double length = glm::length(travel);
  if (!(length > 0)) return {0, 90};
  const glm::dvec3 from = -travel / length;
  double azimuth = degreesFromRadians(std::atan2(from.x, from.y));
  if (azimuth < 0) azimuth += 360;
  return {azimuth, degreesFromRadians(std::asin(std::clamp(from.z, -1.0, 1.0)))};
}

glm::dvec3 lightTravel(const LightAngles& angles) {
  const double a = radiansFromDegrees(angles.azimuth), e = radiansFromDegrees(angles.elevation);
  return -glm::dvec3(std::sin(a) * std::cos(e), std::cos(a) * std::cos(e), std::sin(e));
}

DisplayPanel::DisplayPanel(Session& session, QWidget* parent) : QScrollArea(parent), m_session(session) {
  setWidgetResizable(true);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  setObjectName(QStringLiteral("displayPanel"));
  m_page = new QWidget;
  auto* layout = new QVBoxLayout(m_page);
  layout->setContentsMargins(10, 8, 10, 8);
  layout->setSpacing(4);

  QFormLayout* passes = section(tr("Passes"));
  check(passes, tr("Camera picture (1)"), tr("Draws the camera's picture"), &DisplaySettings::imagePass);
  check(passes, tr("Hiding by the scan (2)"), tr("Lets the scan hide the design"),
        &DisplaySettings::depthPass);
  check(passes, tr("Design (3)"), tr("Draws the design"), &DisplaySettings::designPass);
  check(passes, tr("Scan points (4)"), tr("Draws the scan in its own colour"), &DisplaySettings::pointPass);
  check(passes, tr("Stake-out points"), tr("Draws points to set out with their tolerance circles"),
        &DisplaySettings::stakePoints);
  check(passes, tr("Annotations"), tr("Draws texts, arrows and callouts"), &DisplaySettings::annotations);
  check(passes, tr("Labels"), tr("Writes names beside points"), &DisplaySettings::labels);

  QFormLayout* design = section(tr("Design"));
  choice(
      design, tr("Hidden parts"), tr("How parts that the scan hides are drawn (H)"),
      {tr("Hide"), tr("Ghost"), tr("Dashed")}, [](const auto& d) { return static_cast<double>(d.hidden); },
      [](auto& d, double v) { d.hidden = static_cast<HiddenStyle>(static_cast<int>(v)); });
  number(
      design, tr("Opacity"), tr("Of visible faces; edges stay solid"), tr(" %"), 0, 100, 1, 0,
      [](const auto& d) { return d.designOpacity * 100; },
      [](auto& d, double v) { d.designOpacity = v / 100; });
  check(design, tr("Faces"), tr("Fills the design's faces"), &DisplaySettings::designFaces);
  check(design, tr("Edges"), tr("Draws the design's borders and creases"), &DisplaySettings::designEdges);
  number(
      design, tr("Depth tolerance"), tr("Scan and design closer than this count as one surface"), tr(" mm"),
      0, 1000, 1, 0, [](const auto& d) { return d.depthToleranceM * 1000; },
      [](auto& d, double v) { d.depthToleranceM = v / 1000; });

  QFormLayout* light = section(tr("Light"));
  number(
      light, tr("Azimuth"), tr("Where the light comes from, clockwise from north"), tr("°"), 0, 360, 1, 0,
      [](const auto& d) { return lightAngles(d.lightDirection).azimuth; },
      [](auto& d, double v) {
        d.lightDirection = lightTravel({v, lightAngles(d.lightDirection).elevation});
      });
  number(
      light, tr("Elevation"), tr("How high the light stands above the horizon"), tr("°"), -89, 89, 1, 0,
      [](const auto& d) { return lightAngles(d.lightDirection).elevation; },
      [](auto& d, double v) {
        d.lightDirection = lightTravel({lightAngles(d.lightDirection).azimuth, v});
      });

  QFormLayout* grey = section(tr("Colour"));
  check(grey, tr("Picture in grey (G)"), tr("So that the design stands out"),
        &DisplaySettings::grayscaleImage);
  check(grey, tr("Design in grey"), tr("For a grey picture of a grey camera"),
        &DisplaySettings::grayscaleDesign);

  QFormLayout* points = section(tr("Points"));
  choice(
      points, tr("Density by"), tr("What the density slider counts"),
      {tr("Points a pixel"), tr("Points a square metre")},
      [](const auto& d) { return static_cast<double>(d.densityLaw); },
      [](auto& d, double v) { d.densityLaw = static_cast<DensityLaw>(static_cast<int>(v)); });
  number(
      points, tr("At full density"), tr("Points a square metre one metre away, for the density by area"),
      tr(" k/m²"), 1, 2000, 10, 0, [](const auto& d) { return d.pointsPerSquareMetre / 1000; },
      [](auto& d, double v) { d.pointsPerSquareMetre = v * 1000; });
  check(points, tr("Round points"), tr("Draws points as discs, not squares"), &DisplaySettings::roundPoints);

  layout->addStretch(1);
  setWidget(m_page);
  connect(&session, &Session::displayChanged, this, &DisplayPanel::refresh);
  refresh();
}

QFormLayout* DisplayPanel::section(const QString& title) {
  auto* layout = static_cast<QVBoxLayout*>(m_page->layout());
  if (layout->count() > 0) layout->addSpacing(8);
  auto* label = new QLabel(title);
  label->setProperty("role", "heading");
  layout->addWidget(label);
  auto* form = new QFormLayout;
  form->setContentsMargins(0, 0, 0, 0);
  form->setHorizontalSpacing(10);
  form->setVerticalSpacing(4);
  form->setLabelAlignment(Qt::AlignLeft);
  layout->addLayout(form);
  return form;
}

void DisplayPanel::apply(const std::function<void(DisplaySettings&)>& edit, bool dragging) {
  if (m_refreshing) return;
  DisplaySettings display = m_session.display();
  edit(display);
  m_session.setDisplay(display, dragging);
}

void DisplayPanel::check(QFormLayout* form, const QString& name, const QString& tip,
                         bool DisplaySettings::*member) {
  auto* box = new QCheckBox(name);
  box->setToolTip(tip);
  form->addRow(box);
  connect(box, &QCheckBox::toggled, this,
          [this, member](bool on) { apply([&](DisplaySettings& d) { d.*member = on; }, false); });
  m_refreshers.push_back([box, member](const DisplaySettings& d) { box->setChecked(d.*member); });
}

void DisplayPanel::number(QFormLayout* form, const QString& name, const QString& tip, const QString& unit,
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
  auto* spin = new QDoubleSpinBox;
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
  m_refreshers.push_back([slider, spin, get, low, high](const DisplaySettings& d) {
    const double value = get(d);
    if (!spin->hasFocus() || std::abs(spin->value() - value) > 0.5 * std::pow(10, -spin->decimals()))
      spin->setValue(value);
    if (!slider->isSliderDown())
      slider->setValue(static_cast<int>(std::lround((value - low) / (high - low) * kSteps)));
  });
}

void DisplayPanel::choice(QFormLayout* form, const QString& name, const QString& tip,
                          const QStringList& names, const Get& get, const Set& set) {
  auto* box = new QComboBox;
  box->addItems(names);
  box->setToolTip(tip);
  box->setAccessibleName(name);
  form->addRow(name, box);
  connect(box, &QComboBox::currentIndexChanged, this,
          [this, set](int index) { apply([&](DisplaySettings& d) { set(d, index); }, false); });
  m_refreshers.push_back(
      [box, get](const DisplaySettings& d) { box->setCurrentIndex(static_cast<int>(get(d))); });
}

void DisplayPanel::refresh() {
  m_refreshing = true;
  for (const auto& refresher : m_refreshers) refresher(m_session.display());
  m_refreshing = false;
}

}  // namespace alidade
