// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "ui/window_fixture.h"

#include <cmath>

#include <QApplication>
#include <QElapsedTimer>
#include <QMouseEvent>

#include "app/jobs.h"

namespace alidade::test {

const std::string& demoProject() {
  static const QTemporaryDir folder;
  static const std::string path = [] {
    DemoOptions options;
    options.points = 60'000;
    options.frames = 6;
    options.width = 480;
    options.height = 360;
    options.truth = false;
    auto made = makeDemo(folder.path().toStdString(), options, Progress());
    return made ? *made : "failed: " + made.error().text();
  }();
  return path;
}

bool waitFor(const std::function<bool()>& condition, int timeoutMs) {
  QElapsedTimer clock;
  clock.start();
  while (!condition()) {
    if (clock.elapsed() > timeoutMs) return false;
    QTest::qWait(10);
  }
  return true;
}

void OpenWindow::SetUp() {
  ASSERT_TRUE(demoProject().ends_with(".alidade")) << demoProject();
  window = std::make_unique<MainWindow>();
  window->resize(1400, 900);
  window->show();
  ASSERT_TRUE(QTest::qWaitForWindowExposed(window.get()));
  window->openPaths({QString::fromStdString(demoProject())});
  ASSERT_TRUE(waitFor([this] { return session().hasProject(); }));
  ASSERT_TRUE(settle());
  ASSERT_NE(session().rendered(), nullptr);
  window->activateWindow();
  ASSERT_TRUE(QTest::qWaitForWindowActive(window.get()));
  view().setFocus();
}

void OpenWindow::TearDown() {
  session().undo().clear();
  window.reset();
}

std::optional<glm::dvec2> OpenWindow::pixelOnElement() {
  const PictureProbe& probe = view().probe();
  for (int y = 6; y < probe.rawHeight() - 6; y += 3)
    for (int x = 6; x < probe.rawWidth() - 6; x += 3) {
      const auto here = probe.elementAt({x, y});
      if (!here || !probe.stakePointAt({x, y}, 14.0 / view().zoom()).empty()) continue;
      bool same = true;
      for (const auto& by : {glm::dvec2(3, 0), glm::dvec2(-3, 0), glm::dvec2(0, 3), glm::dvec2(0, -3)}) {
        const auto there = probe.elementAt(glm::dvec2(x, y) + by);
        same = same && there && there->element == here->element && there->design == here->design;
      }
      if (same) return glm::dvec2(x, y);
    }
  return std::nullopt;
}

std::optional<glm::dvec2> OpenWindow::pixelOnScan(bool supported, const glm::dvec2& away) {
  const PictureProbe& probe = view().probe();
  for (int y = probe.rawHeight() / 4; y < probe.rawHeight() * 3 / 4; y += 2)
    for (int x = probe.rawWidth() / 4; x < probe.rawWidth() * 3 / 4; x += 2)
      if (glm::length(glm::dvec2(x, y) - away) > 20 && probe.readout({x, y}).world.has_value() == supported &&
          probe.stakePointAt({x, y}, 20.0).empty())
        return glm::dvec2(x, y);
  return std::nullopt;
}

void OpenWindow::hover(const glm::dvec2& raw) {
  const QPointF at = view().viewFromRaw(raw).toPoint();
  QMouseEvent move(QEvent::MouseMove, at, view().mapToGlobal(at), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
  QApplication::sendEvent(&view(), &move);
}

void OpenWindow::click(const glm::dvec2& raw, Qt::MouseButton button) {
  const QPoint at = view().viewFromRaw(raw).toPoint();
  hover(raw);
  QTest::mouseClick(&view(), button, Qt::NoModifier, at);
}

}  // namespace alidade::test
