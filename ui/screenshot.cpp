// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/screenshot.h"

#include <cstdio>
#include <memory>

#include <QAction>
#include <QCoreApplication>
#include <QDialog>
#include <QElapsedTimer>
#include <QPainter>
#include <QPixmap>
#include <QTimer>

#include "ui/main_window.h"

namespace alidade {

namespace {

constexpr int kStepMs = 100;
constexpr int kStillSteps = 4;  // at rest this long in a row
constexpr qint64 kPatienceMs = 120'000;

struct State {
  QStringList commands;
  QElapsedTimer clock;
  int still = 0;
};

}  // namespace

void takeScreenshot(MainWindow& window, const QString& path, const QStringList& commands) {
  auto state = std::make_shared<State>();
  state->commands = commands;
  state->clock.start();
  auto* timer = new QTimer(&window);
  QObject::connect(timer, &QTimer::timeout, &window, [&window, path, state, timer] {
    state->still = window.settled() ? state->still + 1 : 0;
    const bool late = state->clock.elapsed() > kPatienceMs;
    if (state->still < kStillSteps && !late) return;
    if (!state->commands.isEmpty() && !late) {
      const QString name = state->commands.takeFirst();
      state->still = 0;
      if (auto* action = window.findChild<QAction*>(name))
        action->trigger();
      else
        std::fprintf(stderr, "No command is named %s\n", qPrintable(name));
      return;
    }
    timer->stop();
    QPixmap picture = window.grab();
    QPainter painter(&picture);
    for (QDialog* dialog : window.findChildren<QDialog*>())
      if (dialog->isVisible()) painter.drawPixmap(dialog->pos() - window.pos(), dialog->grab());
    painter.end();
    const bool saved = picture.save(path);
    if (!saved) std::fprintf(stderr, "The screenshot could not be written to %s\n", qPrintable(path));
    QCoreApplication::exit(saved && !late ? 0 : 1);
  });
  timer->start(kStepMs);
}

}  // namespace alidade
