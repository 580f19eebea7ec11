// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <QAction>
#include <QComboBox>
#include <QPushButton>
#include <QTableWidget>

#include "ui/pose_refinement.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace {

struct Seen {
  QString name;
  glm::dvec2 pixel;
};

/// Control points that fall well inside the picture.
std::vector<Seen> controlPointsInView(const Project& project, const Frame& frame) {
  const Camera& camera = project.findCamera(frame.camera)->camera;
  std::vector<Seen> seen;
  for (const ControlPoint& point : project.controlPoints) {
    const auto pixel = camera.project(*frame.cameraFromWorld * point.position);
    if (pixel && pixel->x > 10 && pixel->y > 10 && pixel->x < camera.width() - 10 && pixel->y < camera.height() - 10)
      seen.push_back({QString::fromStdString(point.name), *pixel});
  }
  return seen;
}

}  // namespace

TEST_F(OpenWindow, APoseIsRefinedFromClickedControlPointsAcceptedAndUndone) {
  window->actions()[Command::Resection]->trigger();
  auto* panel = window->findChild<QWidget*>("ResectionPanelForm");
  if (!panel) panel = window->findChild<QTableWidget*>("observationTable")->parentWidget();
  auto* points = panel->findChild<QComboBox*>("point");
  auto* pick = panel->findChild<QPushButton*>("pick");
  auto* refine = panel->findChild<QPushButton*>("refine");
  auto* accept = panel->findChild<QPushButton*>("accept");
  ASSERT_TRUE(points && pick && refine && accept);
  ASSERT_TRUE(settle());

  const Frame before = *session().currentFrame();
  const auto seen = controlPointsInView(*session().project(), before);
  ASSERT_GE(seen.size(), 6u) << "the demo shows too few control points";
  const std::size_t earlier = session().project()->observations.size();
  std::size_t clicked = 0;
  for (const Seen& point : seen) {
    points->setCurrentIndex(points->findText(point.name));
    ASSERT_TRUE(pick->isEnabled());
    QTest::mouseClick(pick, Qt::LeftButton);
    // The picture shows the target where the file's pose puts it, but for the click's own half pixel.
    click(point.pixel + glm::dvec2(clicked % 2 ? 0.4 : -0.4, clicked % 3 ? 0.3 : -0.6));
    ++clicked;
    ASSERT_TRUE(waitFor([&] { return session().project()->observations.size() == earlier + clicked; }, 10'000))
        << point.name.toStdString();
    ASSERT_TRUE(settle());
  }
  EXPECT_EQ(panel->findChild<QTableWidget*>("observationTable")->rowCount(), static_cast<int>(clicked));

  QTest::mouseClick(refine, Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return accept->isEnabled(); }, 20'000));
  QTest::mouseClick(accept, Qt::LeftButton);
  ASSERT_TRUE(settle());
  const Frame& refined = *session().currentFrame();
  EXPECT_EQ(refined.poseSource, PoseSource::Refined);
  ASSERT_TRUE(refined.quality);
  EXPECT_LT(refined.quality->rmsPx, 2.0);
  EXPECT_LT(glm::length(refined.cameraFromWorld->centre() - before.cameraFromWorld->centre()), 0.3);
  EXPECT_NE(refined.cameraFromWorld->translation, before.cameraFromWorld->translation);

  window->actions()[Command::Undo]->trigger();
  EXPECT_EQ(session().currentFrame()->poseSource, before.poseSource);
  EXPECT_EQ(session().currentFrame()->cameraFromWorld->translation, before.cameraFromWorld->translation);
}

}  // namespace alidade::test
