// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/cleaning_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>

#include "ui/figure_spin.h"
#include "ui/format.h"

namespace alidade {

namespace {

QCheckBox* step(QFormLayout* form, const QString& objectName, const QString& name, const QString& tip) {
  auto* box = new QCheckBox(name);
  box->setObjectName(objectName);
  box->setToolTip(tip);
  form->addRow(box);
  return box;
}

QSpinBox* count(QFormLayout* form, const QString& name, const QString& tip, int value, int high) {
  auto* spin = new QSpinBox;
  spin->setRange(1, high);
  spin->setValue(value);
  spin->setToolTip(tip);
  spin->setAccessibleName(name);
  form->addRow(name, spin);
  return spin;
}

/// Rows that say how a step is done show where it is wanted.
void showWith(QFormLayout* form, QCheckBox* box, std::initializer_list<QWidget*> rows) {
  const auto show = [form, rows = std::vector<QWidget*>(rows)](bool on) {
    for (QWidget* row : rows) form->setRowVisible(row, on);
  };
  QObject::connect(box, &QCheckBox::toggled, box, show);
  show(box->isChecked());
}

void refill(QComboBox* box, const std::vector<Scan>& scans) {
  const QVariant kept = box->currentData();
  const QSignalBlocker quiet(box);
  box->clear();
  for (const Scan& scan : scans) box->addItem(text(scan.name), QVariant::fromValue<qlonglong>(scan.id.value));
  const int at = box->findData(kept);
  if (at >= 0) box->setCurrentIndex(at);
}

ScanId chosen(const QComboBox* box) {
  ScanId id;
  id.value = box->currentData().toLongLong();
  return id;
}

}  // namespace

CleaningPanel::CleaningPanel(Session& session, ScanWork& work, QWidget* parent) : SettingsForm(session, parent), m_work(work) {
  setObjectName(QStringLiteral("cleaningPanel"));
  buildScan();
  buildSteps();
  buildRegistration();
  finish();
  connect(&session, &Session::structureChanged, this, &CleaningPanel::refillScans);
  connect(&session, &Session::projectChanged, this, &CleaningPanel::refillScans);
  connect(&work, &ScanWork::changed, this, &CleaningPanel::refresh);
  refillScans();
}

QDoubleSpinBox* CleaningPanel::length(QFormLayout* form, const QString& name, const QString& tip, double value, double low, double high) {
  auto* spin = new FigureSpin;
  spin->setRange(low, high);
  spin->setDecimals(3);
  spin->setSingleStep(0.01);
  spin->setValue(value);
  spin->setSuffix(tr(" m"));
  spin->setToolTip(tip);
  spin->setAccessibleName(name);
  form->addRow(name, spin);
  return spin;
}

void CleaningPanel::buildScan() {
  QFormLayout* form = section(tr("Scan"));
  m_scan = new QComboBox;
  m_scan->setObjectName(QStringLiteral("cleanedScan"));
  m_scan->setAccessibleName(tr("Scan"));
  m_scan->setToolTip(tr("What is cleaned or moved. Its file stays as it is: the result is a new scan"));
  form->addRow(m_scan);
  connect(m_scan, &QComboBox::currentIndexChanged, this, &CleaningPanel::refresh);
}

void CleaningPanel::buildSteps() {
  QFormLayout* form = section(tr("Clean"));
  m_outliers = step(form, QStringLiteral("dropOutliers"), tr("Drop outliers"), tr("Points farther from their neighbours than most points are"));
  const StatisticalOutlierOptions outliers;
  m_outlierNeighbours = count(form, tr("Neighbours"), tr("Whose mean distance counts"), outliers.neighbours, 100);
  m_deviations = new FigureSpin;
  m_deviations->setRange(0.1, 10);
  m_deviations->setSingleStep(0.1);
  m_deviations->setValue(outliers.deviations);
  m_deviations->setAccessibleName(tr("Deviations"));
  m_deviations->setToolTip(tr("Standard deviations above the mean of all points"));
  form->addRow(tr("Deviations"), m_deviations);
  showWith(form, m_outliers, {m_outlierNeighbours, m_deviations});

  const RadiusOutlierOptions radius;
  m_radius = step(form, QStringLiteral("dropLonely"), tr("Drop lonely points"), tr("Points with too few others around them"));
  m_radiusMeters = length(form, tr("Radius"), tr("Around each point"), radius.radiusMeters, 0.001, 10);
  m_radiusNeighbours = count(form, tr("Others"), tr("Wanted within the radius"), radius.neighbours, 1000);
  showWith(form, m_radius, {m_radiusMeters, m_radiusNeighbours});

  m_thin = step(form, QStringLiteral("thinScan"), tr("Thin"), tr("Keeps one point in each cube"));
  m_voxel = length(form, tr("Cube"), tr("Edge of a cube"), 0.02, 0.001, 10);
  showWith(form, m_thin, {m_voxel});

  m_ground = step(form, QStringLiteral("classifyGround"), tr("Classify the ground"), tr("Gives class 2 to the ground, and to nothing else"));
  m_window = length(form, tr("Widest thing"), tr("That stands on the ground; wider ones are taken for ground"), GroundOptions().largestWindowMeters, 1, 200);
  showWith(form, m_ground, {m_window});

  m_clean = new QPushButton(tr("Clean"));
  m_clean->setObjectName(QStringLiteral("runCleaning"));
  m_clean->setToolTip(tr("Writes the cleaned scan beside the project and shows it instead; undo takes it back"));
  form->addRow(m_clean);
  connect(m_clean, &QPushButton::clicked, this, &CleaningPanel::clean);
  for (QCheckBox* box : {m_outliers, m_radius, m_thin, m_ground}) connect(box, &QCheckBox::toggled, this, &CleaningPanel::refresh);
}

void CleaningPanel::buildRegistration() {
  QFormLayout* form = section(tr("Fit to another scan"));
  m_fixed = new QComboBox;
  m_fixed->setObjectName(QStringLiteral("fixedScan"));
  m_fixed->setAccessibleName(tr("Scan that stays"));
  m_fixed->setToolTip(tr("The scan that stays where it is"));
  form->addRow(tr("Stays"), m_fixed);
  const RegistrationOptions options;
  m_reach = length(form, tr("Reach"), tr("How far apart the two may be where they overlap"), options.reachMeters, 0.01, 50);
  m_register = new QPushButton(tr("Register"));
  m_register->setObjectName(QStringLiteral("runRegistration"));
  m_register->setToolTip(tr("Moves the scan so that it fits, and says how well it does; undo takes it back"));
  form->addRow(m_register);
  m_report = new QLabel;
  m_report->setObjectName(QStringLiteral("cleaningReport"));
  m_report->setWordWrap(true);
  m_report->setTextInteractionFlags(Qt::TextSelectableByMouse);
  form->addRow(m_report);
  connect(m_register, &QPushButton::clicked, this, &CleaningPanel::registerScan);
  connect(m_fixed, &QComboBox::currentIndexChanged, this, &CleaningPanel::refresh);
}

ScanCleaning CleaningPanel::wanted() const {
  ScanCleaning cleaning;
  if (m_outliers->isChecked()) cleaning.outliers = {m_outlierNeighbours->value(), m_deviations->value()};
  if (m_radius->isChecked()) cleaning.radius = {m_radiusMeters->value(), m_radiusNeighbours->value()};
  if (m_thin->isChecked()) cleaning.voxelMeters = m_voxel->value();
  if (m_ground->isChecked()) {
    cleaning.ground.emplace();
    cleaning.ground->largestWindowMeters = m_window->value();
  }
  return cleaning;
}

void CleaningPanel::clean() {
  if (m_clean->isEnabled()) m_work.clean(chosen(m_scan), wanted());
}

void CleaningPanel::registerScan() {
  RegistrationOptions options;
  options.reachMeters = m_reach->value();
  if (m_register->isEnabled()) m_work.registerTo(chosen(m_scan), chosen(m_fixed), options);
}

void CleaningPanel::refillScans() {
  refill(m_scan, m_session.project()->scans);
  refill(m_fixed, m_session.project()->scans);
  refresh();
}

void CleaningPanel::refresh() {
  const bool idle = !m_work.running() && m_scan->count() > 0;
  const bool any = m_outliers->isChecked() || m_radius->isChecked() || m_thin->isChecked() || m_ground->isChecked();
  m_clean->setEnabled(idle && any);
  m_clean->setText(m_work.running() ? tr("Working…") : tr("Clean"));
  m_register->setEnabled(idle && m_scan->currentIndex() != m_fixed->currentIndex());
  m_report->setText(m_work.report());
}

}  // namespace alidade
