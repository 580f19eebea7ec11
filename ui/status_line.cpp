// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/status_line.h"

#include <QFrame>
#include <QHBoxLayout>
#include <QLabel>
#include <QToolButton>

#include "ui/format.h"
#include "ui/theme.h"

namespace alidade {

namespace {

QLabel* figure(QHBoxLayout* layout, const QString& name, int width, Qt::Alignment alignment,
               const QString& tip) {
  auto* label = new QLabel;
  label->setObjectName(name);
  label->setMinimumWidth(width);
  label->setAlignment(alignment | Qt::AlignVCenter);
  label->setToolTip(tip);
  layout->addWidget(label);
  return label;
}

void rule(QHBoxLayout* layout) {
  auto* line = new QFrame;
  line->setFixedSize(1, 14);
  line->setStyleSheet(QStringLiteral("background: palette(mid);"));
  layout->addWidget(line);
}

}  // namespace

StatusLine::StatusLine(Session& session, OverlayView& view, QWidget* parent)
    : QWidget(parent), m_session(session), m_view(view) {
  auto* layout = new QHBoxLayout(this);
  layout->setContentsMargins(10, 2, 10, 2);
  layout->setSpacing(12);
  m_pixel = figure(layout, QStringLiteral("statusPixel"), 120, Qt::AlignLeft,
                   tr("Pixel under the cursor; 0, 0 is the middle of the top left one"));
  m_world = figure(layout, QStringLiteral("statusWorld"), 380, Qt::AlignLeft,
                   tr("The scanned point under the cursor and its uncertainty (one sigma)"));
  m_distance = figure(layout, QStringLiteral("statusDistance"), 110, Qt::AlignLeft,
                      tr("From the camera to that point"));
  layout->addStretch(1);
  m_problems = new QToolButton;
  m_problems->setObjectName(QStringLiteral("statusProblems"));
  m_problems->setVisible(false);
  m_problems->setToolTip(tr("Shows the messages (Ctrl+M)"));
  m_problems->setFocusPolicy(Qt::NoFocus);
  layout->addWidget(m_problems);
  m_pose = figure(layout, QStringLiteral("statusPose"), 0, Qt::AlignRight,
                  tr("Where this frame's pose comes from and how good it is"));
  rule(layout);
  m_points =
      figure(layout, QStringLiteral("statusPoints"), 0, Qt::AlignRight, tr("Scan points drawn of all"));
  rule(layout);
  m_error = figure(layout, QStringLiteral("statusError"), 66, Qt::AlignRight,
                   tr("The largest error of a drawn design edge"));
  rule(layout);
  m_speed =
      figure(layout, QStringLiteral("statusSpeed"), 60, Qt::AlignRight, tr("Time that this picture took"));

  connect(&view, &OverlayView::cursorChanged, this, &StatusLine::refreshCursor);
  connect(&session, &Session::pictureReady, this, &StatusLine::refreshPicture);
  connect(&session, &Session::structureChanged, this, &StatusLine::refreshPicture);
  connect(&session, &Session::frameChanged, this, &StatusLine::refreshPose);
  connect(&session, &Session::projectChanged, this, &StatusLine::refreshPose);
  connect(&session, &Session::shownPoseChanged, this, &StatusLine::refreshPose);
  connect(m_problems, &QToolButton::clicked, this, [this] {
    m_problemCount = 0;
    m_problems->setVisible(false);
    emit messagesWanted();
  });
  connect(&session.messages(), &MessageList::added, this, [this](const Message& message) {
    if (message.severity == Severity::Info) return;
    ++m_problemCount;
    m_problems->setText(m_problemCount == 1 ? tr("▲ 1 message") : tr("▲ %1 messages").arg(m_problemCount));
    m_problems->setVisible(true);
  });
  refreshCursor();
  refreshPicture();
}

void StatusLine::refreshCursor() {
  const auto raw = m_view.cursorRaw();
  const CursorReadout& readout = m_view.cursorReadout();
  m_pixel->setText(raw ? formatPixel(*raw) : QStringLiteral("–, – px"));
  if (!readout.world) {
    m_world->setText(raw ? tr("no scan here") : QString());
    m_distance->clear();
    return;
  }
  QString words = formatWorld(*readout.world);
  words += readout.uncertaintyM ? QStringLiteral(" ± %1").arg(formatMillimetres(*readout.uncertaintyM))
                                : tr(" ± not known");
  m_world->setText(words);
  m_distance->setText(tr("%1 away").arg(formatDistance(readout.distanceM)));
}

void StatusLine::refreshPose() {
  const Frame* frame = m_session.shownFrame();
  const bool proposed = frame && frame != m_session.currentFrame();
  m_pose->setText(!frame ? QString() : proposed ? tr("%1, not accepted yet").arg(poseSummary(*frame)) : poseSummary(*frame));
}

void StatusLine::refreshPicture() {
  refreshPose();
  const auto& result = m_session.rendered();
  if (!result || result->problem) {
    m_points->setText(tr("no points"));
    m_error->setText(QStringLiteral("– px"));
    m_speed->setText(QStringLiteral("– ms"));
    return;
  }
  const OverlayPicture& picture = result->frame.picture;
  m_points->setText(formatPointsOf(picture.pointsDrawn, picture.pointsTotal));
  m_error->setText(picture.worstErrorPx > 0 && picture.worstErrorPx < 0.005
                       ? QStringLiteral("< 0.01 px")
                       : QStringLiteral("%1 px").arg(picture.worstErrorPx, 0, 'f', 2));
  m_speed->setText(QStringLiteral("%1 ms").arg(result->renderMs, 0, 'f', 0));
}

}  // namespace alidade
