// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdio>

#include <QGuiApplication>

#include "app/version.h"
#include "base/log.h"
#include "cli/command.h"

namespace {

constexpr int kBadUsage = 2;

/// Qt's own remarks are for developers: to the log, not between the answer and its reader.
void toLog(QtMsgType, const QMessageLogContext&, const QString& text) {
  alidade::log(alidade::LogLevel::Debug, text.toStdString());
}

}  // namespace

int main(int argc, char** argv) {
  using namespace alidade;
  // Text on pictures needs fonts, never a display.
  qputenv("QT_QPA_PLATFORM", "offscreen");
  qInstallMessageHandler(toLog);
  const QGuiApplication application(argc, argv);

  CLI::App app("Alidade: designs over raw images, exactly where they would stand", "alidade-cli");
  app.set_version_flag("--version", std::string(softwareName()));
  app.require_subcommand(1);
  cli::Verbs verbs(app);
  cli::addDemo(verbs);
  cli::addInfo(verbs);
  cli::addNew(verbs);
  cli::addOverlay(verbs);
  cli::addRefine(verbs);
  cli::addProjectPoints(verbs);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadUsage;
  }
  return verbs.run();
}
