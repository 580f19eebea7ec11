// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <chrono>
#include <cstdlib>
#include <thread>

#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QPushButton>

#include "app/jobs.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace {

constexpr int kFrames = 30;
constexpr double kInjectedSecs = 0.2;

/// Two seconds of H.264 with a trajectory whose clock is ahead.
const std::string& videoProject() {
  static const QTemporaryDir folder;
  static const std::string path = [] {
    DemoOptions options;
    options.points = 60'000;
    options.frames = kFrames;
    options.width = 320;
    options.height = 240;
    options.truth = false;
    options.clockOffsetSecs = kInjectedSecs;
    auto made = makeDemo(folder.path().toStdString(), options, Progress(), true);
    return made ? *made : "failed: " + made.error().text();
  }();
  return path;
}

class OpenVideo : public OpenWindow {
 protected:
  void SetUp() override {
    OpenWindow::SetUp();
    if (HasFatalFailure()) return;
    ASSERT_TRUE(videoProject().ends_with(".alidade")) << videoProject();
    window->openPaths({QString::fromStdString(videoProject())});
    ASSERT_TRUE(waitFor([this] { return frames() == kFrames; }));
    ASSERT_TRUE(settle());
  }
  int frames() { return static_cast<int>(session().project()->frames.size()); }
  Playback& playback() { return window->playback(); }
  template <class Widget>
  Widget* named(const char* name) {
    return window->findChild<Widget*>(name);
  }
  void chooseSpeed(const QString& words) {
    auto* speed = named<QComboBox>("playSpeed");
    const int index = speed->findText(words);
    ASSERT_GE(index, 0) << words.toStdString();
    speed->setCurrentIndex(index);
    speed->activated(index);
  }
  QString rateText() { return named<QLabel>("playRate")->text(); }
};

}  // namespace

TEST_F(OpenVideo, PlaysToTheEndAndEachFrameIsShownOrCountedAsDropped) {
  int shown = 0;
  QObject::connect(&session(), &Session::pictureReady, window.get(), [&](const std::shared_ptr<const RenderResult>& result) { shown += result->request.played; });
  EXPECT_TRUE(rateText().contains("15.0 fps camera")) << rateText().toStdString();
  key(Qt::Key_Space);
  ASSERT_TRUE(playback().playing());
  ASSERT_TRUE(waitFor([&] { return session().frameIndex() > 12; }));
  picture("video_playing");
  ASSERT_TRUE(waitFor([&] { return !playback().playing(); }));
  picture("video_played");
  EXPECT_EQ(session().frameIndex(), frames() - 1);
  EXPECT_EQ(shown + playback().dropped(), frames() - 1);
  const QString words = playback().dropped() > 0 ? QStringLiteral("%1 dropped").arg(playback().dropped()) : QStringLiteral("15.0 fps camera");
  EXPECT_TRUE(rateText().contains(words)) << rateText().toStdString();
}

TEST_F(OpenVideo, FramesDroppedWhileNothingIsDrawnAreCountedOnScreen) {
  chooseSpeed("4 ×");
  EXPECT_EQ(playback().speed(), 4.0);
  // A second is more than the video lasts at this speed.
  session().renderLoop().runOnThread([](OverlayRenderer&, PictureCache&) { std::this_thread::sleep_for(std::chrono::seconds(1)); });
  key(Qt::Key_Space);
  ASSERT_TRUE(waitFor([&] { return !playback().playing(); }));
  EXPECT_EQ(session().frameIndex(), frames() - 1);
  EXPECT_GT(playback().dropped(), frames() / 2);
  EXPECT_TRUE(rateText().contains(QStringLiteral("%1 dropped").arg(playback().dropped()))) << rateText().toStdString();
  // The next time counts anew.
  session().setFrameIndex(frames() - 3);
  chooseSpeed("0.1 ×");
  key(Qt::Key_Space);
  EXPECT_EQ(playback().dropped(), 0);
  ASSERT_TRUE(waitFor([&] { return !playback().playing(); }));
  EXPECT_EQ(playback().dropped(), 0);
}

TEST_F(OpenVideo, AnotherSpeedGoesOnFromTheFrameShown) {
  chooseSpeed("0.25 ×");
  key(Qt::Key_Space);
  ASSERT_TRUE(waitFor([&] { return session().frameIndex() >= 3; }));
  const int before = session().frameIndex();
  chooseSpeed("4 ×");
  EXPECT_TRUE(playback().playing());
  EXPECT_EQ(session().frameIndex(), before);
  ASSERT_TRUE(waitFor([&] { return session().frameIndex() > before; }));
  key(Qt::Key_Space);
  EXPECT_FALSE(playback().playing());
}

TEST_F(OpenVideo, AStillPictureIsJudgedInFullAgain) {
  key(Qt::Key_Space);
  ASSERT_TRUE(waitFor([&] { return session().frameIndex() >= 3; }));
  ASSERT_TRUE(session().rendered()->request.played);
  EXPECT_TRUE(session().rendered()->frame.description.playing);
  key(Qt::Key_Space);
  ASSERT_TRUE(settle());
  ASSERT_TRUE(waitFor([&] { return !session().rendered()->request.played; }));
  EXPECT_FALSE(session().rendered()->frame.description.playing);
}

TEST_F(OpenVideo, TheClockPanelShowsSetsAndEstimatesTheOffset) {
  auto* offset = named<QDoubleSpinBox>("clockOffset");
  const auto says = [&](const char* name) { return named<QLabel>(name)->text(); };
  EXPECT_TRUE(says("clockTrajectory").contains("trajectory")) << says("clockTrajectory").toStdString();
  EXPECT_EQ(says("clockStd"), QStringLiteral("± not known"));
  EXPECT_TRUE(says("clockTimes").contains("own time stamps")) << says("clockTimes").toStdString();
  EXPECT_EQ(offset->value(), 0.0);
  const glm::dvec3 before = session().currentFrame()->cameraFromWorld->centre();

  offset->setValue(0.15);
  EXPECT_EQ(session().project()->trajectories.front().clockOffsetSecs, 0.15);
  EXPECT_GT(glm::length(session().currentFrame()->cameraFromWorld->centre() - before), 0.02);
  session().undo().undo();
  EXPECT_EQ(offset->value(), 0.0);
  EXPECT_LT(glm::length(session().currentFrame()->cameraFromWorld->centre() - before), 1e-9);

  for (auto* dock : window->findChildren<QDockWidget*>())
    if (dock->findChild<QWidget*>("clockPanel")) dock->raise();
  named<QPushButton>("clockEstimate")->click();
  EXPECT_FALSE(named<QPushButton>("clockEstimate")->isEnabled());
  ASSERT_TRUE(waitFor([&] { return session().jobs().idle() && named<QPushButton>("clockEstimate")->isEnabled(); }));
  ASSERT_TRUE(settle());
  picture("clock_panel");
  const Trajectory& trajectory = session().project()->trajectories.front();
  ASSERT_TRUE(trajectory.clockOffsetStdSecs) << says("clockAnswer").toStdString();
  EXPECT_NEAR(trajectory.clockOffsetSecs, kInjectedSecs, 4 * *trajectory.clockOffsetStdSecs + 0.0001);
  EXPECT_NEAR(offset->value(), trajectory.clockOffsetSecs, 1e-4);
  EXPECT_TRUE(says("clockStd").contains("estimated"));
  EXPECT_TRUE(says("clockAnswer").contains("Clock offset")) << says("clockAnswer").toStdString();
}

}  // namespace alidade::test
