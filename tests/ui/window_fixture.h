// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include <QTemporaryDir>
#include <QTest>

#include <gtest/gtest.h>

#include "ui/main_window.h"
#include "ui/overlay_view.h"

namespace alidade::test {

/// A small demo site, made once for all cases and never written to.
const std::string& demoProject();

/// Runs the event loop until `condition`, or fails after `timeoutMs`.
bool waitFor(const std::function<bool()>& condition, int timeoutMs = 60'000);

/// The real window with the demo site open, loaded and rendered.
class OpenWindow : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  Session& session() { return window->session(); }
  OverlayView& view() { return window->overlay(); }
  bool settle() {
    return waitFor([this] { return window->settled(); });
  }
  /// A picture pixel in the middle of a patch that shows one visible element.
  std::optional<glm::dvec2> pixelOnElement();
  /// A picture pixel that the scan supports, or one that it does not; at least 20 px from `away`.
  std::optional<glm::dvec2> pixelOnScan(bool supported, const glm::dvec2& away = glm::dvec2(-1e6));
  /// The cursor comes to rest there. (QTest moves the server's pointer and does not wait for it.)
  void hover(const glm::dvec2& raw);
  void click(const glm::dvec2& raw, Qt::MouseButton button = Qt::LeftButton);
  /// For looking at: into the folder of ALIDADE_TEST_PICTURES.
  void picture(const QString& name) {
    if (const char* into = std::getenv("ALIDADE_TEST_PICTURES")) window->grab().save(QStringLiteral("%1/%2.png").arg(into, name));
  }
  void key(Qt::Key key, Qt::KeyboardModifiers modifiers = Qt::NoModifier) {
    QTest::keyClick(&view(), key, modifiers);
  }

  QTemporaryDir folder;
  std::unique_ptr<MainWindow> window;
};

}  // namespace alidade::test
