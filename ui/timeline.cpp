// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/timeline.h"

#include <algorithm>
#include <cmath>

#include <QComboBox>
#include <QHBoxLayout>
#include <QHelpEvent>
#include <QLabel>
#include <QMouseEvent>
#include <QPainter>
#include <QToolButton>
#include <QToolTip>

#include "ui/format.h"
#include "ui/theme.h"

namespace alidade {

FrameStrip::FrameStrip(Session& session, QWidget* parent) : QWidget(parent), m_session(session) {
  setObjectName(QStringLiteral("frameStrip"));
  setMouseTracking(true);
  for (const auto signal : {&Session::frameChanged, &Session::projectChanged, &Session::structureChanged})
    connect(&session, signal, this, qOverload<>(&QWidget::update));
}

int FrameStrip::frameAt(double x) const {
  const int count = static_cast<int>(m_session.project()->frames.size());
  if (count == 0) return -1;
  return std::clamp(static_cast<int>(std::floor((x - 6) / std::max(1.0, width() - 12.0) * count)), 0,
                    count - 1);
}

void FrameStrip::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const QRectF area = QRectF(rect()).adjusted(6, 3, -6, -3);
  painter.fillRect(area, colours().ground);
  if (m_session.project()->frames.empty()) return;
  paintTicks(painter, area);
  paintMarks(painter, area);
  const double step = area.width() / static_cast<double>(m_session.project()->frames.size());
  const double x = area.left() + (m_session.frameIndex() + 0.5) * step;
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  if (step > 6) {
    QColor band = colours().accent;
    band.setAlpha(70);
    painter.fillRect(QRectF(x - step / 2, area.top(), step, area.height()), band);
  }
  painter.setBrush(colours().accent);
  painter.drawRect(QRectF(x - 1, area.top(), 2, area.height()));
  painter.drawPolygon(QPolygonF({{x - 5, area.top()}, {x + 5, area.top()}, {x, area.top() + 6}}));
}

void FrameStrip::paintTicks(QPainter& painter, const QRectF& area) const {
  const auto& frames = m_session.project()->frames;
  const double step = area.width() / static_cast<double>(frames.size());
  const double w = std::max(1.0, step > 3 ? step - 1 : step);
  const double floor = area.bottom() - 1;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double x = area.left() + static_cast<double>(i) * step;
    const double mm = poseMillimetresAt(frames[i], 10.0);
    switch (frames[i].poseSource) {
      case PoseSource::None:
        painter.fillRect(QRectF(x, floor - 3, w, 3), QBrush(colours().bad, Qt::Dense4Pattern));
        break;
      case PoseSource::Interpolated:
        painter.fillRect(QRectF(x, floor - 8, w, 8), QBrush(colours().dimText, Qt::Dense4Pattern));
        break;
      case PoseSource::File:
        painter.fillRect(QRectF(x, floor - 10, w, 10), colours().line);
        break;
      case PoseSource::Refined: {
        // Taller is better: 1 mm at 10 m fills the strip, 100 mm is as low as a pose from a file.
        const double good = mm > 0 ? std::clamp(1.0 - std::log10(std::max(mm, 1.0)) / 2.0, 0.0, 1.0) : 0.5;
        const double h = 10 + good * (area.height() - 20);
        painter.fillRect(QRectF(x, floor - h, w, h), colours().good);
        break;
      }
    }
  }
}

void FrameStrip::paintMarks(QPainter& painter, const QRectF& area) const {
  const Project& project = *m_session.project();
  const double step = area.width() / static_cast<double>(project.frames.size());
  painter.setPen(Qt::NoPen);
  painter.setBrush(colours().caution);
  for (const Annotation& annotation : project.annotations) {
    const auto it = std::find_if(project.frames.begin(), project.frames.end(),
                                 [&](const Frame& f) { return f.id == annotation.frame; });
    if (it == project.frames.end()) continue;
    const double x = area.left() + (static_cast<double>(it - project.frames.begin()) + 0.5) * step;
    painter.drawRect(QRectF(x - 2, area.top() + 8, 4, 4));
  }
}

void FrameStrip::mousePressEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) m_session.setFrameIndex(frameAt(event->position().x()));
}

void FrameStrip::mouseMoveEvent(QMouseEvent* event) {
  if (event->buttons() & Qt::LeftButton) m_session.setFrameIndex(frameAt(event->position().x()));
}

bool FrameStrip::event(QEvent* event) {
  if (event->type() == QEvent::ToolTip) {
    auto* help = static_cast<QHelpEvent*>(event);
    const int index = frameAt(help->pos().x());
    if (index >= 0) {
      const Frame& frame = m_session.project()->frames[static_cast<std::size_t>(index)];
      QToolTip::showText(help->globalPos(),
                         QStringLiteral("%1, %2\n%3")
                             .arg(text(frame.name), formatSeconds(frame.timeSecs), poseSummary(frame)));
    }
    return true;
  }
  return QWidget::event(event);
}

Timeline::Timeline(Session& session, Playback& playback, const Actions& actions, QWidget* parent)
    : QWidget(parent), m_session(session), m_playback(playback) {
  setObjectName(QStringLiteral("timeline"));
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(4);
  for (const Command command : {Command::PreviousFrame, Command::Play, Command::NextFrame}) {
    auto* button = new QToolButton;
    button->setDefaultAction(actions[command]);
    button->setToolButtonStyle(Qt::ToolButtonIconOnly);
    button->setIconSize({16, 16});
    button->setFocusPolicy(Qt::NoFocus);
    layout->addWidget(button);
  }
  m_position = new QLabel;
  m_position->setMinimumWidth(84);
  m_position->setAlignment(Qt::AlignCenter);
  m_time = new QLabel;
  m_time->setMinimumWidth(70);
  m_strip = new FrameStrip(session);
  m_rate = new QLabel;
  m_rate->setObjectName(QStringLiteral("playRate"));
  m_rate->setProperty("role", "dim");
  m_rate->setToolTip(tr("While it plays, what hides the design is judged on half the picture's width and height, lines may be off by half a pixel, "
                        "and where that does not keep up the picture is drawn at half size. Stopped, it is drawn in full"));
  m_rate->setMinimumWidth(150);
  m_rate->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  m_speed = new QComboBox;
  m_speed->setObjectName(QStringLiteral("playSpeed"));
  m_speed->setToolTip(tr("How fast it plays"));
  m_speed->setFocusPolicy(Qt::ClickFocus);
  for (const double factor : {0.1, 0.25, 0.5, 1.0, 2.0, 4.0}) m_speed->addItem(tr("%1 ×").arg(factor), factor);
  m_speed->setCurrentIndex(m_speed->findData(1.0));
  connect(m_speed, &QComboBox::activated, this, [this](int index) { m_playback.setSpeed(m_speed->itemData(index).toDouble()); });
  m_list = new QComboBox;
  m_list->setToolTip(tr("All frames"));
  m_list->setMinimumWidth(170);
  m_list->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  m_list->setFocusPolicy(Qt::ClickFocus);
  m_list->setMaxVisibleItems(24);
  layout->addWidget(m_position);
  layout->addWidget(m_time);
  layout->addWidget(m_strip, 1);
  layout->addWidget(m_rate);
  layout->addWidget(m_speed);
  layout->addWidget(m_list);
  connect(m_list, &QComboBox::activated, this, [this](int index) { m_session.setFrameIndex(index); });
  connect(&session, &Session::structureChanged, this, &Timeline::refillList);
  connect(&session, &Session::frameChanged, this, &Timeline::refresh);
  connect(&playback, &Playback::changed, this, &Timeline::refresh);
  refillList();
}

void Timeline::refillList() {
  QStringList names;
  for (const Frame& frame : m_session.project()->frames) names << text(frame.name);
  m_list->clear();
  m_list->addItems(names);
  refresh();
}

void Timeline::refresh() {
  const int count = static_cast<int>(m_session.project()->frames.size());
  const int index = m_session.frameIndex();
  m_position->setText(count == 0 ? tr("no frames") : QStringLiteral("%1 / %2").arg(index + 1).arg(count));
  const Frame* frame = m_session.currentFrame();
  m_time->setText(frame ? formatSeconds(frame->timeSecs) : QString());
  m_list->setCurrentIndex(index);
  if (m_playback.playing() || m_playback.dropped() > 0) {
    QString words = tr("%1 fps shown, %2 dropped").arg(m_playback.shownPerSecond(), 0, 'f', 1).arg(m_playback.dropped());
    if (m_playback.playing() && m_playback.atHalfSize()) words = tr("half size, ") + words;
    m_rate->setText(words);
  } else {
    m_rate->setText(count > 1 ? tr("%1 fps camera").arg(Playback::cameraRate(*m_session.project()), 0, 'f', 1)
                              : QString());
  }
}

}  // namespace alidade
