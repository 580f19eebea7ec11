// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdio>

#include <QApplication>
#include <QCommandLineParser>
#include <QSettings>
#include <QSurfaceFormat>

#include "ui/main_window.h"
#include "ui/screenshot.h"
#include "ui/start.h"
#include "ui/theme.h"

int main(int argc, char** argv) {
  alidade::prepareGraphics();
  QApplication application(argc, argv);
  alidade::nameApplication();

  QCommandLineParser parser;
  parser.setApplicationDescription(QObject::tr("Survey inspection: the design drawn on calibrated pictures"));
  parser.addHelpOption();
  parser.addVersionOption();
  const QCommandLineOption screenshot(
      QStringLiteral("screenshot"),
      QObject::tr("Waits until all is loaded, saves a picture of the window, leaves"),
      QStringLiteral("file.png"));
  const QCommandLineOption run(QStringLiteral("do"),
                               QObject::tr("Runs a command first, such as showBoth; may be repeated"),
                               QStringLiteral("command"));
  const QCommandLineOption theme(QStringLiteral("theme"), QObject::tr("dark, light or contrast"),
                                 QStringLiteral("name"));
  const QCommandLineOption size(QStringLiteral("window-size"), QObject::tr("Size of the window"),
                                QStringLiteral("WxH"));
  parser.addOptions({screenshot, run, theme, size});
  parser.addPositionalArgument(QStringLiteral("files"),
                               QObject::tr("A project, or scans, pictures and designs"),
                               QStringLiteral("[files…]"));
  parser.process(application);

  const QString wanted =
      parser.isSet(theme) ? parser.value(theme) : QSettings().value(QStringLiteral("theme")).toString();
  alidade::applyTheme(application, alidade::themeNamed(wanted));
  alidade::MainWindow window;
  const QStringList sides = parser.value(size).split('x');
  if (sides.size() == 2) window.resize(sides[0].toInt(), sides[1].toInt());
  window.show();
  if (!parser.positionalArguments().isEmpty()) window.openPaths(parser.positionalArguments());
  if (parser.isSet(screenshot)) alidade::takeScreenshot(window, parser.value(screenshot), parser.values(run));
  return application.exec();
}
