// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/clock_panel.h"

#include <algorithm>

#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>

#include "app/clock_estimation.h"
#include "app/pose_clock.h"
#include "ui/figure_spin.h"
#include "ui/format.h"

namespace alidade {

namespace {

QLabel* wordsLabel(const QString& name, bool dim) {
  auto* label = new QLabel;
  label->setObjectName(name);
  label->setWordWrap(true);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  if (dim) label->setProperty("role", "dim");
  return label;
}

QString timingText(const Project& project, const Frame& frame) {
  const Video* video = project.findVideo(frame.video);
  const QString at = formatSeconds(frame.timeSecs);
  if (!video) return ClockPanel::tr("Frame at %1").arg(at);
  switch (video->timing) {
    case FrameTiming::Container: return ClockPanel::tr("Frame at %1, by the video's own time stamps").arg(at);
    case FrameTiming::ConstantRate: return ClockPanel::tr("Frame at %1, at a constant rate").arg(at);
    case FrameTiming::Table: return ClockPanel::tr("Frame at %1, from a table of times").arg(at);
  }
  return {};
}

}  // namespace

ClockPanel::ClockPanel(Session& session, QWidget* parent) : QWidget(parent), m_session(session) {
  setObjectName(QStringLiteral("clockPanel"));
  m_name = wordsLabel(QStringLiteral("clockTrajectory"), false);
  m_std = wordsLabel(QStringLiteral("clockStd"), true);
  m_poses = wordsLabel(QStringLiteral("clockPoses"), true);
  m_times = wordsLabel(QStringLiteral("clockTimes"), true);
  m_answer = wordsLabel(QStringLiteral("clockAnswer"), false);
  m_offset = new FigureSpin;
  m_offset->setObjectName(QStringLiteral("clockOffset"));
  m_offset->setDecimals(4);
  m_offset->setRange(-1e10, 1e10);
  m_offset->setSingleStep(0.01);
  m_offset->setSuffix(tr(" s"));
  m_offset->setKeyboardTracking(false);
  m_offset->setToolTip(tr("The poses' clock minus the pictures': a frame has the pose of its time plus this"));
  m_readout = new FigureSpin;
  m_readout->setObjectName(QStringLiteral("clockReadout"));
  m_readout->setDecimals(2);
  m_readout->setRange(-200, 200);
  m_readout->setSuffix(tr(" ms"));
  m_readout->setKeyboardTracking(false);
  m_readout->setToolTip(tr("How long the camera takes to read its rows, top to bottom; 0 for a global shutter"));
  m_estimate = new QPushButton(tr("Estimate"));
  m_estimate->setObjectName(QStringLiteral("clockEstimate"));
  m_estimate->setToolTip(tr("Finds the offset from what moves in the pictures"));

  auto* form = new QFormLayout(this);
  form->setContentsMargins(10, 8, 10, 8);
  form->addRow(tr("Poses"), m_name);
  form->addRow(tr("Clock offset"), m_offset);
  form->addRow(QString(), m_std);
  form->addRow(QString(), m_estimate);
  form->addRow(QString(), m_answer);
  form->addRow(QString(), m_poses);
  form->addRow(tr("Times"), m_times);
  form->addRow(tr("Row read-out"), m_readout);

  connect(m_offset, &QDoubleSpinBox::valueChanged, this, &ClockPanel::setOffset);
  connect(m_readout, &QDoubleSpinBox::valueChanged, this, &ClockPanel::setReadout);
  connect(m_estimate, &QPushButton::clicked, this, &ClockPanel::estimate);
  for (const auto signal : {&Session::frameChanged, &Session::projectChanged, &Session::structureChanged})
    connect(&session, signal, this, &ClockPanel::refresh);
  connect(&session, &Session::projectOpened, m_answer, &QLabel::clear);
  refresh();
}

const Trajectory* ClockPanel::trajectory() const {
  const Project& project = *m_session.project();
  const Frame* frame = m_session.currentFrame();
  if (const Trajectory* its = frame ? project.findTrajectory(frame->trajectory) : nullptr) return its;
  return project.trajectories.empty() ? nullptr : &project.trajectories.front();
}

void ClockPanel::refresh() {
  setEnabled(!m_session.playing());
  if (m_session.playing()) return;
  const QSignalBlocker offset(m_offset), readout(m_readout);
  const Project& project = *m_session.project();
  const Trajectory* its = trajectory();
  const Frame* frame = m_session.currentFrame();
  const CameraRecord* camera = m_session.currentCamera();
  m_offset->setEnabled(its != nullptr);
  m_estimate->setEnabled(its != nullptr && !m_running);
  m_readout->setEnabled(camera != nullptr);
  m_times->setText(frame ? timingText(project, *frame) : QString());
  m_readout->setValue(camera ? 1000 * camera->readoutSecs : 0);
  if (!its) {
    m_name->setText(tr("No trajectory with times. Drop a TUM or EuRoC file"));
    m_offset->setValue(0);
    m_std->clear();
    m_poses->clear();
    return;
  }
  m_name->setText(tr("%1, %2 poses").arg(text(its->name), formatCount(its->track.samples().size())));
  m_offset->setValue(its->clockOffsetSecs);
  m_std->setText(its->clockOffsetStdSecs ? tr("± %1 ms, estimated").arg(1000 * *its->clockOffsetStdSecs, 0, 'f', 1)
                                         : tr("± not known"));
  PoseCount count;
  for (const Frame& served : project.frames) {
    if (served.trajectory != its->id) continue;
    if (served.cameraFromWorld) ++count.posed;
    else ++count.without[its->track.at(served.timeSecs + its->clockOffsetSecs).gap];
  }
  m_poses->setText(text(poseCountText(count)));
}

void ClockPanel::setOffset() {
  const Trajectory* its = trajectory();
  if (!its || m_offset->value() == its->clockOffsetSecs) return;
  const TrajectoryId id = its->id;
  m_answer->clear();
  Project changed = *m_session.project();
  if (const auto set = setClockOffset(changed, id, m_offset->value()); !set) {
    m_session.messages().error(set.error());
    m_offset->setValue(its->clockOffsetSecs);
    return;
  }
  m_session.change(tr("Set clock offset"), [&](Project& project) { project = changed; });
}

void ClockPanel::setReadout() {
  const CameraRecord* camera = m_session.currentCamera();
  if (!camera) return;
  const CameraId id = camera->id;
  m_session.change(tr("Set row read-out"), [&](Project& project) {
    for (CameraRecord& record : project.cameras)
      if (record.id == id) record.readoutSecs = m_readout->value() / 1000;
  });
}

void ClockPanel::estimate() {
  const Trajectory* its = trajectory();
  if (!its || m_running) return;
  m_running = true;
  m_answer->setText(tr("Estimating…"));
  m_estimate->setEnabled(false);
  const TrajectoryId id = its->id;
  const auto project = m_session.project();
  m_session.jobs().run(
      tr("Estimating the clock offset"),
      [project, id](const Progress& progress) -> Result<ClockOffset> {
        PictureCache pictures(16);
        return estimateClock(*project, id, {}, pictures, progress);
      },
      [this, id](Result<ClockOffset> answer) {
        m_running = false;
        if (!answer) {
          m_answer->clear();
          m_session.messages().error(answer.error());
        } else {
          m_answer->setText(reportText(answer->report()));
          if (answer->found && m_session.project()->findTrajectory(id))
            m_session.change(tr("Estimate clock offset"), [&](Project& changed) {
              setClockOffset(changed, id, answer->offsetSecs, answer->stdSecs);
            });
        }
        refresh();
      });
}

}  // namespace alidade
