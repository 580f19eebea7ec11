// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/welcome_page.h"

#include <QAction>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QVBoxLayout>

#include "ui/theme.h"

namespace alidade {

namespace {

/// A dashed frame that says what may be dropped.
class DropArea : public QWidget {
 public:
  DropArea() {
    setMinimumHeight(150);
    setAccessibleName(WelcomePage::tr("Drop files here"));
  }
  void setHighlighted(bool on) {
    m_on = on;
    update();
  }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter p(this);
    p.setRenderHint(QPainter::Antialiasing);
    const ThemeColours& c = colours();
    p.setPen(QPen(m_on ? c.accent : c.line, m_on ? 2 : 1.5, Qt::DashLine));
    p.setBrush(m_on ? c.raised : c.ground);
    p.drawRoundedRect(QRectF(rect()).adjusted(1, 1, -1, -1), 6, 6);
    icon(QStringLiteral("add")).paint(&p, QRect(width() / 2 - 12, height() / 2 - 42, 24, 24));
    p.setPen(c.text);
    p.setFont(bodyFont());
    p.drawText(rect().adjusted(16, height() / 2 - 8, -16, 0), Qt::AlignTop | Qt::AlignHCenter,
               WelcomePage::tr("Drop a scan, pictures and a design together"));
    p.setPen(c.dimText);
    p.setFont(smallFont());
    p.drawText(
        rect().adjusted(24, height() / 2 + 16, -24, -8), Qt::AlignTop | Qt::AlignHCenter | Qt::TextWordWrap,
        WelcomePage::tr("LAS, PLY, PCD · images, video · COLMAP, OpenCV, TUM cameras · IFC, OBJ, glTF, STL · "
                        "stake-out points as CSV"));
  }

 private:
  bool m_on = false;
};

QPushButton* actionButton(QAction* action, bool first) {
  auto* button = new QPushButton(action->icon(), QString(action->text()));
  button->setToolTip(action->toolTip());
  button->setMinimumHeight(34);
  button->setObjectName(action->objectName() + QStringLiteral("Button"));
  if (first) button->setDefault(true);
  QObject::connect(button, &QPushButton::clicked, action, &QAction::trigger);
  return button;
}

}  // namespace

WelcomePage::WelcomePage(ProjectFiles& files, const Actions& actions, QWidget* parent)
    : QWidget(parent), m_files(files) {
  setObjectName(QStringLiteral("welcomePage"));
  auto* outer = new QHBoxLayout(this);
  outer->addStretch(1);
  auto* column = new QVBoxLayout;
  outer->addLayout(column, 4);
  outer->addStretch(1);
  column->addStretch(1);

  auto* title = new QLabel(tr("Alidade"));
  title->setProperty("role", "title");
  title->setStyleSheet(QStringLiteral("font-size: 30px;"));
  auto* under =
      new QLabel(tr("See the design on the picture, bent by the lens and hidden where the scan hides it."));
  under->setWordWrap(true);
  column->addWidget(title);
  column->addWidget(under);
  column->addSpacing(22);

  auto* buttons = new QHBoxLayout;
  buttons->setSpacing(8);
  buttons->addWidget(actionButton(actions[Command::OpenSample], true));
  buttons->addWidget(actionButton(actions[Command::OpenProject], false));
  buttons->addWidget(actionButton(actions[Command::NewProject], false));
  buttons->addStretch(1);
  column->addLayout(buttons);
  column->addSpacing(18);

  m_drop = new DropArea;
  column->addWidget(m_drop);
  column->addSpacing(22);
  auto* heading = new QLabel(tr("Recent projects"));
  heading->setProperty("role", "heading");
  column->addWidget(heading);
  column->addSpacing(4);
  m_recent = new QVBoxLayout;
  m_recent->setSpacing(2);
  column->addLayout(m_recent);
  column->addStretch(2);
  connect(&files, &ProjectFiles::recentChanged, this, &WelcomePage::refreshRecent);
  refreshRecent();
}

void WelcomePage::refreshRecent() {
  while (QLayoutItem* item = m_recent->takeAt(0)) {
    if (item->widget()) item->widget()->deleteLater();
    delete item;
  }
  const QStringList paths = m_files.recent();
  for (const QString& path : paths) {
    const QFileInfo info(path);
    auto* button =
        new QPushButton(QStringLiteral("%1     %2").arg(info.completeBaseName(), info.absolutePath()));
    button->setFlat(true);
    button->setStyleSheet(QStringLiteral(
        "text-align: left; background: transparent; border-color: transparent; padding: 4px 6px;"));
    button->setToolTip(path);
    connect(button, &QPushButton::clicked, this, [this, path] { m_files.open(path); });
    m_recent->addWidget(button);
  }
  if (paths.isEmpty()) {
    auto* none = new QLabel(tr("None yet. The sample inspection is a good start."));
    none->setProperty("role", "dim");
    m_recent->addWidget(none);
  }
}

void WelcomePage::setDropHighlighted(bool on) {
  static_cast<DropArea*>(m_drop)->setHighlighted(on);
}

void WelcomePage::paintEvent(QPaintEvent*) {
  QPainter(this).fillRect(rect(), colours().panel);
}

}  // namespace alidade
