// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/points_panel.h"

#include <algorithm>
#include <cmath>

#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QPainter>
#include <QPushButton>

#include "geometry/angle.h"
#include "survey/classification.h"
#include "ui/figure_spin.h"
#include "ui/format.h"
#include "ui/histogram_view.h"

namespace alidade {

namespace {

constexpr double kFar = 1e8;  ///< beyond any survey's coordinates, metres

QIcon swatch(const glm::u8vec3& colour) {
  QPixmap square(12, 12);
  square.fill(QColor(colour.r, colour.g, colour.b));
  return {square};
}

QDoubleSpinBox* rangeEnd(const QString& name) {
  auto* spin = new FigureSpin;
  spin->setRange(-1e15, 1e15);
  spin->setDecimals(3);
  spin->setButtonSymbols(QAbstractSpinBox::NoButtons);
  spin->setKeyboardTracking(false);
  spin->setAlignment(Qt::AlignRight);
  spin->setMinimumWidth(40);  // wide ranges would ask for more than the panel has
  spin->setAccessibleName(name);
  spin->setToolTip(name);
  return spin;
}

QString unitOf(ColourBy by) {
  switch (by) {
    case ColourBy::Height:
    case ColourBy::Distance: return QStringLiteral(" m");
    case ColourBy::GpsTime: return QStringLiteral(" s");
    default: return {};
  }
}

bool hasRange(ColourBy by) {
  return by == ColourBy::Intensity || by == ColourBy::Height || by == ColourBy::Return || by == ColourBy::GpsTime ||
         by == ColourBy::Distance;
}

/// All rows but the first, the switch itself.
void showDetails(QFormLayout* form, bool on) {
  for (int row = 1; row < form->rowCount(); ++row) form->setRowVisible(row, on);
}

}  // namespace

PointsPanel::PointsPanel(Session& session, QWidget* parent) : SettingsForm(session, parent) {
  setObjectName(QStringLiteral("pointsPanel"));
  buildColour();
  buildClasses();
  buildBox();
  buildSection();
  buildCuts();
  buildLook();
  buildPace();
  finish();
  connect(&session, &Session::dataChanged, this, &PointsPanel::onData);
  onData();
}

void PointsPanel::buildColour() {
  QFormLayout* form = section(tr("Colour"));
  choice(
      form, tr("Colour by"), tr("What gives a scan point its colour"),
      {tr("Its own colour"), tr("Intensity"), tr("Height"), tr("Class"), tr("Return"), tr("Time"), tr("Scan"),
       tr("Distance to the camera"), tr("Normal")},
      [](const auto& d) { return static_cast<double>(d.points.colourBy); },
      [](auto& d, double v) {
        d.points.colourBy = static_cast<ColourBy>(static_cast<int>(v));
        d.points.automaticRange = true;
      });
  choice(
      form, tr("Ramp"), tr("How a number becomes a colour"), {tr("Viridis"), tr("Cividis"), tr("Grey")},
      [](const auto& d) { return static_cast<double>(d.points.ramp); },
      [](auto& d, double v) { d.points.ramp = static_cast<ColourRamp>(static_cast<int>(v)); });
  check(
      form, tr("Automatic range"), tr("From the 1st to the 99th percentile of the values"),
      [](const auto& d) { return d.points.automaticRange; },
      [this](auto& d, bool on) {
        d.points.automaticRange = on;
        if (const auto values = histogramOf(d.points.colourBy); !on && values) {
          d.points.rangeLow = values->p01;
          d.points.rangeHigh = values->p99;
        }
      });
  auto* ends = new QWidget;
  auto* row = new QHBoxLayout(ends);
  row->setContentsMargins(0, 0, 0, 0);
  m_low = rangeEnd(tr("Start of the range"));
  m_high = rangeEnd(tr("End of the range"));
  row->addWidget(m_low);
  row->addWidget(m_high);
  form->addRow(tr("Range"), ends);
  m_histogram = new HistogramView;
  form->addRow(m_histogram);
  m_rangeNote = new QLabel;
  m_rangeNote->setWordWrap(true);
  m_rangeNote->setProperty("role", "note");
  form->addRow(m_rangeNote);

  const auto setRange = [this](double low, double high, bool dragging) {
    apply(
        [&](DisplaySettings& d) {
          d.points.automaticRange = false;
          d.points.rangeLow = std::min(low, high);
          d.points.rangeHigh = std::max(low, high);
        },
        dragging);
  };
  connect(m_histogram, &HistogramView::rangeDragged, this, setRange);
  for (QDoubleSpinBox* spin : {m_low, m_high})
    connect(spin, &QDoubleSpinBox::valueChanged, this, [this, setRange] { setRange(m_low->value(), m_high->value(), false); });
  follow([this](const DisplaySettings& d) { refreshRange(d); });
}

void PointsPanel::buildClasses() {
  QFormLayout* form = section(tr("Classes"));
  m_classes = new QListWidget;
  m_classes->setObjectName(QStringLiteral("classList"));
  m_classes->setToolTip(tr("Points of a class that is not ticked neither show nor hide the design"));
  m_classes->setSelectionMode(QAbstractItemView::NoSelection);
  form->addRow(m_classes);
  m_noClasses = new QLabel(tr("The scans carry no classes"));
  m_noClasses->setProperty("role", "note");
  form->addRow(m_noClasses);
  connect(m_classes, &QListWidget::itemChanged, this, [this](QListWidgetItem* item) {
    if (m_filling) return;
    apply([&](DisplaySettings& d) {
      d.points.hiddenClasses.set(item->data(Qt::UserRole).toUInt(), item->checkState() != Qt::Checked);
    });
  });
  follow([this](const DisplaySettings& d) { refreshClasses(d); });
}

void PointsPanel::buildBox() {
  QFormLayout* form = section(tr("Clip box"));
  check(
      form, tr("Use only points inside"), tr("Points outside the box neither show nor hide the design"),
      [](const auto& d) { return d.points.clipBox.on; },
      [this](auto& d, bool on) {
        d.points.clipBox.on = on;
        const Bounds around = boundsOfInterest();
        if (on && d.points.clipBox.centre == glm::dvec3(0) && !around.empty()) {
          d.points.clipBox.centre = around.centre();
          d.points.clipBox.size = around.size();
        }
      });
  auto* around = new QPushButton(tr("Around the selection"));
  around->setObjectName(QStringLiteral("boxAroundSelection"));
  around->setToolTip(tr("Puts the box around the selected element, half a metre wider; around the scans where nothing is selected"));
  form->addRow(around);
  connect(around, &QPushButton::clicked, this, &PointsPanel::boxAroundInterest);
  const QString centre[] = {tr("Centre E"), tr("Centre N"), tr("Centre H")}, size[] = {tr("Width"), tr("Length"), tr("Height")};
  for (int i = 0; i < 3; ++i)
    figure(
        form, centre[i], tr("Middle of the box"), tr(" m"), -kFar, kFar, 0.1, 3,
        [i](const auto& d) { return d.points.clipBox.centre[i]; },
        [i](auto& d, double v) { d.points.clipBox.centre[i] = v; });
  for (int i = 0; i < 3; ++i)
    figure(
        form, size[i], tr("Of the box"), tr(" m"), 0.001, kFar, 0.1, 3,
        [i](const auto& d) { return d.points.clipBox.size[i]; },
        [i](auto& d, double v) { d.points.clipBox.size[i] = v; });
  number(
      form, tr("Heading"), tr("Direction of the box's length, clockwise from north"), tr("°"), -180, 180, 1, 1,
      [](const auto& d) { return degreesFromRadians(d.points.clipBox.headingRad); },
      [](auto& d, double v) { d.points.clipBox.headingRad = radiansFromDegrees(v); });
  follow([form](const DisplaySettings& d) { showDetails(form, d.points.clipBox.on); });
}

void PointsPanel::buildSection() {
  QFormLayout* form = section(tr("Section"));
  check(
      form, tr("Use only a slab"), tr("A vertical or inclined slice through the scan"),
      [](const auto& d) { return d.points.section.on; },
      [this](auto& d, bool on) {
        d.points.section.on = on;
        const Bounds around = boundsOfInterest();
        if (on && d.points.section.point == glm::dvec3(0) && !around.empty()) d.points.section.point = around.centre();
      });
  auto* through = new QPushButton(tr("Through the selection"));
  through->setObjectName(QStringLiteral("sectionThroughSelection"));
  through->setToolTip(tr("Moves the section to the middle of the selected element; of the scans where nothing is selected"));
  form->addRow(through);
  connect(through, &QPushButton::clicked, this, &PointsPanel::sectionThroughInterest);
  number(
      form, tr("Faces"), tr("Direction of its normal, clockwise from north"), tr("°"), 0, 360, 1, 1,
      [](const auto& d) { return degreesFromRadians(d.points.section.azimuthRad); },
      [](auto& d, double v) { d.points.section.azimuthRad = radiansFromDegrees(v); });
  number(
      form, tr("Tilt"), tr("Of its normal above the horizon: 90° is a level slice"), tr("°"), -90, 90, 1, 1,
      [](const auto& d) { return degreesFromRadians(d.points.section.elevationRad); },
      [](auto& d, double v) { d.points.section.elevationRad = radiansFromDegrees(v); });
  figure(
      form, tr("Thickness"), tr("Of the slab; 0 keeps everything behind the plane"), tr(" m"), 0, 1e5, 0.05, 3,
      [](const auto& d) { return d.points.section.thicknessM; },
      [](auto& d, double v) { d.points.section.thicknessM = v; });
  figure(
      form, tr("Place"), tr("Of its middle along its normal"), tr(" m"), -2 * kFar, 2 * kFar, 0.05, 3,
      [](const auto& d) { return glm::dot(d.points.section.normal(), d.points.section.point); },
      [](auto& d, double v) {
        const glm::dvec3 normal = d.points.section.normal();
        d.points.section.point += (v - glm::dot(normal, d.points.section.point)) * normal;
      });
  follow([form](const DisplaySettings& d) { showDetails(form, d.points.section.on); });
}

void PointsPanel::buildLook() {
  QFormLayout* form = section(tr("Density and size"));
  choice(
      form, tr("Density by"), tr("What the density slider counts"),
      {tr("Points a pixel"), tr("Points a square metre")},
      [](const auto& d) { return static_cast<double>(d.densityLaw); },
      [](auto& d, double v) { d.densityLaw = static_cast<DensityLaw>(static_cast<int>(v)); });
  choice(
      form, tr("Thinned"), tr("What a distance is taken of when far points are left out: a part of the scan, each point, or the nearest part for all"),
      {tr("Part by part"), tr("Point by point"), tr("All alike")},
      [](const auto& d) { return static_cast<double>(d.levelThreshold); },
      [](auto& d, double v) { d.levelThreshold = static_cast<LevelThreshold>(static_cast<int>(v)); });
  number(
      form, tr("At full density"), tr("Points a square metre one metre away, for the density by area"),
      tr(" k/m²"), 1, 2000, 10, 0, [](const auto& d) { return d.pointsPerSquareMetre / 1000; },
      [](auto& d, double v) { d.pointsPerSquareMetre = v * 1000; });
  choice(
      form, tr("Size"), tr("How large a point is drawn, before the factor of the tool bar"),
      {tr("Closes the surface"), tr("By distance alone"), tr("The same for all")},
      [](const auto& d) { return static_cast<double>(d.points.sizeLaw); },
      [](auto& d, double v) { d.points.sizeLaw = static_cast<PointSizeLaw>(static_cast<int>(v)); });
  check(form, tr("Round points"), tr("Draws points as discs, not squares"), &DisplaySettings::roundPoints);
  check(
      form, tr("Eye-Dome lighting"), tr("Darkens depth steps, so that shapes stand out without colour"),
      [](const auto& d) { return d.points.eyeDome; }, [](auto& d, bool on) { d.points.eyeDome = on; });
  number(
      form, tr("Strength"), tr("Of the Eye-Dome lighting"), QString(), 0.1, 5, 0.1, 1,
      [](const auto& d) { return d.points.eyeDomeStrength; },
      [](auto& d, double v) { d.points.eyeDomeStrength = v; });
}

/// A matter of the machine: kept with the user's settings, not with the project.
void PointsPanel::buildPace() {
  QFormLayout* form = section(tr("While the view moves"));
  const auto row = [&](const QString& objectName, const QString& name, const QString& tip, double high, double FramePace::*member) {
    auto* spin = new FigureSpin;
    spin->setObjectName(objectName);
    spin->setRange(0, high);
    spin->setDecimals(0);
    spin->setSingleStep(5);
    spin->setSuffix(tr(" ms"));
    spin->setAccessibleName(name);
    spin->setToolTip(tip);
    spin->setKeyboardTracking(false);
    spin->setValue(m_session.pace().*member);
    form->addRow(name, spin);
    connect(spin, &QDoubleSpinBox::valueChanged, this, [this, member](double ms) {
      FramePace pace = m_session.pace();
      pace.*member = ms;
      m_session.setPace(pace);
    });
  };
  row(QStringLiteral("frameTime"), tr("Time of a frame"), tr("Fewer points are used to keep it; the still picture has all. 0 always uses all"), 500,
      &FramePace::frameTimeMs);
  auto* most = new FigureSpin;
  most->setObjectName(QStringLiteral("mostPoints"));
  most->setRange(0, 10'000);
  most->setDecimals(2);
  most->setSuffix(tr(" M"));
  most->setSpecialValueText(tr("no limit"));
  most->setAccessibleName(tr("Points at most"));
  most->setToolTip(tr("No more points than these are used while the view moves, however quick it is; the still picture has all"));
  most->setKeyboardTracking(false);
  most->setValue(static_cast<double>(m_session.pace().mostPoints) / 1e6);
  form->addRow(tr("Points at most"), most);
  connect(most, &QDoubleSpinBox::valueChanged, this, [this](double millions) {
    FramePace pace = m_session.pace();
    pace.mostPoints = static_cast<std::uint64_t>(std::llround(millions * 1e6));
    m_session.setPace(pace);
  });
  row(QStringLiteral("selectionAge"), tr("Points serve for"), tr("The points chosen for one frame serve the next ones for so long. 0 chooses for each"),
      1000, &FramePace::selectionAgeMs);
}

void PointsPanel::onData() {
  m_summary.reset();
  if (const auto& data = m_session.data())
    for (const auto& [id, parts] : data->scans)
      for (const ScanLayer& part : parts)
        if (const auto& summary = part.points.summary) m_summary = m_summary ? merged(*m_summary, *summary) : *summary;
  m_filling = true;
  m_classes->clear();
  std::uint64_t all = 0;
  if (m_summary)
    for (const std::uint64_t count : m_summary->classes) all += count;
  for (int code = 0; all > 0 && code < 256; ++code) {
    const std::uint64_t count = m_summary->classes[static_cast<std::size_t>(code)];
    if (count == 0) continue;
    const auto byte = static_cast<std::uint8_t>(code);
    const double percent = 100.0 * static_cast<double>(count) / static_cast<double>(all);
    auto* item = new QListWidgetItem(swatch(classificationColour(byte)),
                                     tr("%1  %2   %3 %").arg(code).arg(text(classificationName(byte)))
                                         .arg(percent, 0, 'f', percent < 1 ? 2 : 0));
    item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsUserCheckable);
    item->setData(Qt::UserRole, code);
    m_classes->addItem(item);
  }
  const int rows = m_classes->count();
  m_classes->setVisible(rows > 0);
  m_noClasses->setVisible(rows == 0);
  m_classes->setFixedHeight(std::clamp(rows, 1, 8) * 21 + 6);
  m_filling = false;
  refreshClasses(m_session.display());
  refreshRange(m_session.display());
}

std::optional<ValueHistogram> PointsPanel::histogramOf(ColourBy by) const {
  if (!m_summary) return std::nullopt;
  const auto found = m_summary->values.find(by);
  return found == m_summary->values.end() ? std::nullopt : std::optional(found->second);
}

void PointsPanel::refreshRange(const DisplaySettings& display) {
  const PointStyle& style = display.points;
  const auto values = histogramOf(style.colourBy);
  const double low = style.automaticRange && values ? values->p01 : style.rangeLow;
  const double high = style.automaticRange && values ? values->p99 : style.rangeHigh;
  for (QDoubleSpinBox* spin : {m_low, m_high}) {
    const QSignalBlocker quiet(spin);
    spin->setSuffix(unitOf(style.colourBy));
    spin->setEnabled(hasRange(style.colourBy));
    spin->setValue(spin == m_low ? low : high);
  }
  m_histogram->setHistogram(values, style.ramp);
  m_histogram->setRange(low, high);
  const bool missing = m_summary && !m_summary->has(style.colourBy);
  m_rangeNote->setVisible(missing);
  if (missing) m_rangeNote->setText(tr("The scans carry no such column: their points are drawn grey"));
}

void PointsPanel::refreshClasses(const DisplaySettings& display) {
  m_filling = true;
  for (int row = 0; row < m_classes->count(); ++row) {
    QListWidgetItem* item = m_classes->item(row);
    const bool hidden = display.points.hiddenClasses.test(item->data(Qt::UserRole).toUInt());
    item->setCheckState(hidden ? Qt::Unchecked : Qt::Checked);
  }
  m_filling = false;
}

Bounds PointsPanel::boundsOfInterest() const {
  const SelectionState& selected = m_session.selection();
  if (const DesignModel* model = m_session.model(selected.design); model && selected.element >= 0)
    return model->elementBounds(static_cast<std::size_t>(selected.element));
  Bounds all;
  if (const auto& data = m_session.data())
    for (const auto& [id, parts] : data->scans)
      for (const ScanLayer& part : parts) all.add(part.points.store->bounds());
  return all;
}

void PointsPanel::boxAroundInterest() {
  const Bounds around = boundsOfInterest();
  if (around.empty()) return;
  constexpr double kMarginM = 0.5;
  apply([&](DisplaySettings& d) {
    d.points.clipBox = {true, around.centre(), around.size() + 2 * kMarginM, 0};
  });
}

void PointsPanel::sectionThroughInterest() {
  const Bounds around = boundsOfInterest();
  if (around.empty()) return;
  apply([&](DisplaySettings& d) {
    d.points.section.on = true;
    d.points.section.point = around.centre();
  });
}

}  // namespace alidade
