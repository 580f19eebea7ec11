// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/mount_panel.h"

#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include "geometry/angle.h"
#include "ui/figure_spin.h"
#include "ui/format.h"

namespace alidade {

namespace {

QLabel* note(const QString& words) {
  auto* label = new QLabel(words);
  label->setWordWrap(true);
  label->setProperty("role", "dim");
  return label;
}

QDoubleSpinBox* field(const QString& objectName, double low, double high, int decimals, double step, const QString& unit, const QString& tip) {
  auto* spin = new FigureSpin;
  spin->setObjectName(objectName);
  spin->setRange(low, high);
  spin->setDecimals(decimals);
  spin->setSingleStep(step);
  spin->setSuffix(unit);
  spin->setAlignment(Qt::AlignRight);
  spin->setButtonSymbols(QAbstractSpinBox::NoButtons);
  spin->setMinimumWidth(60);
  spin->setKeyboardTracking(false);
  spin->setAccessibleName(tip);
  spin->setToolTip(tip);
  return spin;
}

}  // namespace

MountPanel::MountPanel(Session& session, QWidget* parent) : QWidget(parent), m_session(session) {
  setObjectName(QStringLiteral("mountPanel"));
  m_camera = new QLabel;
  m_camera->setWordWrap(true);
  m_note = note({});
  m_note->setObjectName(QStringLiteral("mountNote"));
  m_problem = new QLabel;
  m_problem->setObjectName(QStringLiteral("mountProblem"));
  m_problem->setWordWrap(true);
  m_problem->setProperty("role", "note");
  m_on = new QCheckBox(tr("Sits on a body"));
  m_on->setObjectName(QStringLiteral("mountOn"));
  m_on->setToolTip(tr("A sensor whose trajectory is known, or another camera of the rig, carries this camera"));
  m_body = new QComboBox;
  m_body->setObjectName(QStringLiteral("mountBody"));
  m_body->setEditable(true);
  m_body->setInsertPolicy(QComboBox::NoInsert);
  m_body->setToolTip(tr("What carries the camera; cameras on the same body make one rig"));

  m_fields = new QWidget;
  auto* grid = new QGridLayout(m_fields);
  grid->setContentsMargins(0, 4, 0, 0);
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(4);
  grid->setColumnStretch(1, 3);
  grid->setColumnStretch(3, 2);
  int row = 0;
  grid->addWidget(new QLabel(tr("Body")), row, 0);
  grid->addWidget(m_body, row++, 1, 1, 3);
  const auto place = [&](const QString& name, Pair& pair) {
    grid->addWidget(new QLabel(name), row, 0);
    grid->addWidget(pair.value, row, 1);
    grid->addWidget(new QLabel(QStringLiteral("±")), row, 2);
    grid->addWidget(pair.std, row++, 3);
    connect(pair.value, &QDoubleSpinBox::valueChanged, this, &MountPanel::take);
    connect(pair.std, &QDoubleSpinBox::valueChanged, this, &MountPanel::take);
  };
  const QString axes[] = {QStringLiteral("x"), QStringLiteral("y"), QStringLiteral("z")};
  const QString turns[] = {QStringLiteral("ω"), QStringLiteral("φ"), QStringLiteral("κ")};
  grid->addWidget(note(tr("The camera's centre, in the body's axes; ± along the camera's")), row++, 0, 1, 4);
  for (std::size_t i = 0; i < 3; ++i) {
    const QString& axis = axes[i];
    m_position[i] = {field("mount_" + axis, -1e5, 1e5, 4, 0.001, tr(" m"), tr("Along the body's %1").arg(axis)),
                     field("mountStd_" + axis, 0, 1e5, 1, 0.1, tr(" mm"), tr("Standard deviation along the camera's %1; 0: not known").arg(axis))};
    place(axis, m_position[i]);
  }
  grid->addWidget(note(tr("How it is turned: about the body's x, then the new y, then the new z; ± about the camera's axes")), row++, 0, 1, 4);
  for (std::size_t i = 0; i < 3; ++i) {
    m_angles[i] = {field("mountTurn_" + axes[i], -180, 180, 4, 0.01, tr("°"), tr("Turn about %1").arg(axes[i])),
                   field("mountTurnStd_" + axes[i], 0, 180, 4, 0.001, tr("°"), tr("Standard deviation about the camera's %1; 0: not known").arg(axes[i]))};
    place(turns[i], m_angles[i]);
  }

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(10, 8, 10, 8);
  for (QWidget* part : std::initializer_list<QWidget*>{m_camera, m_on, m_fields, m_problem, m_note}) layout->addWidget(part);
  layout->addStretch(1);

  connect(m_on, &QCheckBox::toggled, this, &MountPanel::take);
  connect(m_body->lineEdit(), &QLineEdit::editingFinished, this, &MountPanel::take);
  connect(m_body, &QComboBox::activated, this, &MountPanel::take);
  for (const auto signal : {&Session::frameChanged, &Session::projectChanged, &Session::structureChanged})
    connect(&session, signal, this, &MountPanel::refresh);
  refresh();
}

void MountPanel::refresh() {
  setEnabled(!m_session.playing());
  if (m_session.playing()) return;
  const CameraRecord* camera = m_session.currentCamera();
  const auto& mount = camera ? camera->mount : std::nullopt;
  m_shown = camera ? camera->id : CameraId();
  m_problem->hide();
  m_camera->setText(camera ? text(camera->name) : tr("This frame has no camera"));
  m_on->setEnabled(camera != nullptr);
  const QSignalBlocker quiet(m_on);
  m_on->setChecked(mount.has_value());
  m_fields->setVisible(mount.has_value());
  m_note->setText(!camera ? QString()
                  : mount ? tr("Poses on the camera's trajectory follow; refined ones stay")
                          : tr("Its poses are its own"));
  if (!mount) return;
  const MountFigures its = figuresOf(*mount);
  fillBodies(text(its.body));
  for (int i = 0; i < 3; ++i) {
    const auto show = [](QDoubleSpinBox* spin, double value) {
      const QSignalBlocker still(spin);
      spin->setValue(value);
    };
    const auto at = static_cast<std::size_t>(i);
    show(m_position[at].value, its.positionM[i]);
    show(m_position[at].std, 1000 * its.positionStdM[i]);
    show(m_angles[at].value, degreesFromRadians(its.anglesRad[i]));
    show(m_angles[at].std, degreesFromRadians(its.anglesStdRad[i]));
  }
}

/// What is known to carry cameras: trajectories, cameras and the bodies of other mounts.
void MountPanel::fillBodies(const QString& body) {
  const QSignalBlocker quiet(m_body);
  QStringList names{body};
  const Project& project = *m_session.project();
  for (const CameraRecord& camera : project.cameras) {
    if (camera.mount) names << text(camera.mount->body);
    names << text(camera.name);
  }
  for (const Trajectory& trajectory : project.trajectories) names << text(trajectory.name);
  names.removeDuplicates();
  m_body->clear();
  m_body->addItems(names);
  m_body->setCurrentText(body);
}

/// What was not touched keeps all its digits.
MountFigures MountPanel::figures() const {
  const CameraRecord* camera = m_session.currentCamera();
  MountFigures figures = camera && camera->mount ? figuresOf(*camera->mount) : MountFigures();
  figures.body = m_body->currentText().trimmed().toStdString();
  const auto read = [](const QDoubleSpinBox* spin, double& value, double factor) {
    const double half = 0.51 * std::pow(10.0, -spin->decimals());
    if (std::abs(spin->value() - factor * value) > half) value = spin->value() / factor;
  };
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    read(m_position[at].value, figures.positionM[i], 1);
    read(m_position[at].std, figures.positionStdM[i], 1000);
    read(m_angles[at].value, figures.anglesRad[i], degreesFromRadians(1));
    read(m_angles[at].std, figures.anglesStdRad[i], degreesFromRadians(1));
  }
  return figures;
}

void MountPanel::take() {
  const CameraRecord* camera = m_session.currentCamera();
  // A field that is left half typed when another frame comes speaks of the camera that was shown.
  if (!camera || m_session.playing() || camera->id != m_shown) return;
  std::optional<CameraMount> wanted;
  const auto refuse = [this](const Error& error) {
    m_problem->setText(errorText(error));
    m_problem->show();
  };
  if (m_on->isChecked() && !camera->mount) {
    const Trajectory* trajectory = m_session.currentFrame() ? m_session.project()->findTrajectory(m_session.currentFrame()->trajectory) : nullptr;
    wanted = CameraMount{trajectory ? trajectory->name : "body", RigidTransform::identity()};
  } else if (m_on->isChecked()) {
    const MountFigures is = figures();
    if (is == figuresOf(*camera->mount)) return refresh();  // a field was left as it was
    auto mount = mountOf(is);
    if (!mount) return refuse(mount.error());
    wanted = std::move(*mount);
  } else if (!camera->mount) {
    return;
  }
  Project changed = *m_session.project();
  if (const auto set = setMount(changed, camera->id, wanted); !set) return refuse(set.error());
  const QString name = wanted ? tr("Set mount of %1").arg(text(camera->name)) : tr("Remove mount of %1").arg(text(camera->name));
  m_session.change(name, [&](Project& project) { project = std::move(changed); });
}

}  // namespace alidade
