// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QAction>
#include <QLabel>
#include <QPushButton>

#include "ui/pose_refinement.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace {

/// The demo site as if it had not been scanned yet: pictures are aligned with the design.
class AlignmentWindow : public OpenWindow {
 protected:
  void SetUp() override {
    OpenWindow::SetUp();
    session().change("Hide scan", [](Project& project) { project.scans.front().visible = false; });
    window->actions()[Command::Resection]->trigger();
    ASSERT_TRUE(settle());
    refinement = window->findChild<PoseRefinement*>();
    summary = window->findChild<QLabel*>("summary");
    ASSERT_TRUE(refinement && summary);
  }

  /// Mean distance in pixels between where two poses put the control points that the first one sees.
  double apartPx(const Frame& frame, const RigidTransform& a, const RigidTransform& b) {
    const Camera& camera = session().project()->findCamera(frame.camera)->camera;
    double sum = 0;
    int count = 0;
    for (const ControlPoint& point : session().project()->controlPoints) {
      const auto p = camera.project(a * point.position), q = camera.project(b * point.position);
      if (!p || !q || p->x < 0 || p->y < 0 || p->x >= camera.width() || p->y >= camera.height()) continue;
      sum += glm::distance(*p, *q), ++count;
    }
    return count > 0 ? sum / count : 1e9;
  }

  PoseRefinement* refinement = nullptr;
  QLabel* summary = nullptr;
};

}  // namespace

TEST_F(AlignmentWindow, ADisturbedPoseIsFoundAgainFromTheDesignAcceptedAndUndone) {
  const Frame before = *session().currentFrame();
  const RigidTransform truth = *before.cameraFromWorld;
  RigidTransform off = truth;
  off.rotation = glm::angleAxis(0.02, glm::normalize(glm::dvec3(0.3, 1, 0.2))) * off.rotation;
  off.translation = -(off.rotation * (truth.centre() + glm::dvec3(0.08, -0.05, 0.03)));
  session().change("Disturb", [&](Project& project) { project.findFrame(before.id)->cameraFromWorld = off; });
  ASSERT_TRUE(settle());
  const double startPx = apartPx(before, truth, off);
  ASSERT_GT(startPx, 5);

  refinement->setJudgedAt(session().project()->controlPoints.front().position);
  auto* pose = window->findChild<QLabel*>("statusPose");
  EXPECT_TRUE(pose->text().startsWith("From file")) << pose->text().toStdString();
  QTest::mouseClick(window->findChild<QPushButton*>("align"), Qt::LeftButton);
  ASSERT_TRUE(waitFor([this] { return !refinement->running(); }));
  ASSERT_TRUE(refinement->alignment());
  ASSERT_TRUE(refinement->hasCandidate()) << refinement->alignment()->report();
  EXPECT_TRUE(summary->text().contains("Aligned")) << summary->text().toStdString();
  EXPECT_TRUE(summary->text().contains("chosen point")) << summary->text().toStdString();
  EXPECT_TRUE(pose->text().startsWith("Refined") && pose->text().endsWith("not accepted yet")) << pose->text().toStdString();
  session().setShowBefore(true);
  EXPECT_TRUE(pose->text().startsWith("From file")) << "what is shown then";
  session().setShowBefore(false);
  ASSERT_TRUE(settle());
  picture("aligned");
  QTest::mouseClick(window->findChild<QPushButton*>("accept"), Qt::LeftButton);
  ASSERT_TRUE(settle());
  EXPECT_FALSE(pose->text().contains("accepted"));
  EXPECT_LT(apartPx(before, truth, *session().currentFrame()->cameraFromWorld), 1.0) << "from " << startPx << " px";
  EXPECT_EQ(session().currentFrame()->poseSource, PoseSource::Refined);
  session().undo().undo();
  EXPECT_NEAR(apartPx(before, off, *session().currentFrame()->cameraFromWorld), 0, 1e-9);
}

TEST_F(AlignmentWindow, AllFramesAreAlignedTogether) {
  refinement->setJudgedAt(session().project()->controlPoints.front().position);
  QTest::mouseClick(window->findChild<QPushButton*>("alignAll"), Qt::LeftButton);
  EXPECT_TRUE(refinement->running());
  ASSERT_TRUE(waitFor([this] { return !refinement->running(); }, 180'000));
  ASSERT_TRUE(refinement->sequence());
  EXPECT_EQ(refinement->sequence()->frames.size(), session().project()->frames.size());
  EXPECT_TRUE(refinement->sequence()->converged) << refinement->sequence()->report(*session().project());
  EXPECT_TRUE(summary->text().contains("keyframes")) << summary->text().toStdString();
  EXPECT_TRUE(refinement->hasCandidate());
  ASSERT_TRUE(refinement->expectedHere());
  EXPECT_EQ(refinement->expectedHere()->world, session().project()->controlPoints.front().position);
  ASSERT_TRUE(settle());
  EXPECT_TRUE(summary->text().contains("chosen point")) << summary->text().toStdString();
  picture("aligned together");
}

}  // namespace alidade::test
