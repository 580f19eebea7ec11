// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QGuiApplication>

#include <gtest/gtest.h>

#include "unit/gpu/test_device.h"

/// Text needs a QGuiApplication; the minimal platform needs no display.
int main(int argc, char** argv) {
  alidade::useTestDevice();
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QGuiApplication application(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
