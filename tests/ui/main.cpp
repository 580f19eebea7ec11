// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>

#include <QApplication>
#include <QSettings>
#include <QStandardPaths>
#include <QTemporaryDir>

#include <gtest/gtest.h>

#include "ui/start.h"
#include "ui/theme.h"

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  // Listing the cases, as the build does, needs no display.
  if (::testing::GTEST_FLAG(list_tests)) return RUN_ALL_TESTS();
  setenv("ALIDADE_PLUGIN_PATH", ALIDADE_BINARY_DIR "/lib/alidade/plugins", 0);
  alidade::prepareGraphics();
  QApplication application(argc, argv);
  alidade::nameApplication();
  // The user's own settings and data are none of a test's business.
  QStandardPaths::setTestModeEnabled(true);
  const QTemporaryDir settings;
  QSettings::setDefaultFormat(QSettings::IniFormat);
  QSettings::setPath(QSettings::IniFormat, QSettings::UserScope, settings.path());
  alidade::applyTheme(application, alidade::Theme::Dark);
  return RUN_ALL_TESTS();
}
