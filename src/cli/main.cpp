// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <string_view>

#include <QGuiApplication>

#include <fcntl.h>
#include <unistd.h>

#include "app/version.h"
#include "base/log.h"
#include "cli/command.h"

namespace {

/// Qt's own remarks are for developers: to the log, not between the answer and its reader.
void toLog(QtMsgType, const QMessageLogContext&, const QString& text) {
  alidade::log(alidade::LogLevel::Debug, text.toStdString());
}

/// A stream that was closed would be the next file that anybody opens. In its place stands a device
/// on which every read or write fails, as it should.
void holdClosedStreams() {
  if (::fcntl(STDIN_FILENO, F_GETFD) < 0) (void)::open("/dev/null", O_WRONLY);
  if (::fcntl(STDOUT_FILENO, F_GETFD) < 0) (void)::open("/dev/full", O_WRONLY);
  if (::fcntl(STDERR_FILENO, F_GETFD) < 0) (void)::open("/dev/null", O_WRONLY);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace alidade;
  holdClosedStreams();
  // Text on pictures needs fonts, never a display.
  qputenv("QT_QPA_PLATFORM", "offscreen");
  qInstallMessageHandler(toLog);
  const QGuiApplication application(argc, argv);

  CLI::App app("Alidade: designs over raw images, exactly where they would stand", "alidade-cli");
  app.set_version_flag("--version", std::string(softwareName()));
  app.require_subcommand(1);
  cli::Verbs verbs(app);
  cli::addAdd(verbs);
  cli::addCalibrate(verbs);
  cli::addConvert(verbs);
  cli::addDemo(verbs);
  cli::addIndex(verbs);
  cli::addInfo(verbs);
  cli::addLevels(verbs);
  cli::addNew(verbs);
  cli::addOverlay(verbs);
  cli::addClock(verbs);
  cli::addRefine(verbs);
  cli::addProjectPoints(verbs);
  cli::addPick(verbs);
  cli::addExportCameras(verbs);
  cli::addClean(verbs);
  cli::addRegister(verbs);
  cli::addMesh(verbs);
  cli::addMount(verbs);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help and version
    const bool json = std::any_of(argv + 1, argv + argc, [](std::string_view word) { return word == "--json"; });
    return verbs.refuse(error, json);
  }
  return verbs.run();
}
