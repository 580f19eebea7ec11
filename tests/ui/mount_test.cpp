// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <QCheckBox>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>

#include "app/camera_mount.h"
#include "geometry/angle.h"
#include "ui/window_fixture.h"

namespace alidade::test {

struct MountInWindow : OpenWindow {
  void SetUp() override {
    OpenWindow::SetUp();
    window->actions()[Command::ShowMount]->trigger();
    panel = window->findChild<QWidget*>("mountPanel");
    ASSERT_NE(panel, nullptr);
    ASSERT_TRUE(waitFor([this] { return panel->isVisible(); }));
    panel->findChild<QCheckBox*>("mountOn")->setChecked(true);
    ASSERT_TRUE(mount().has_value());
  }
  const std::optional<CameraMount>& mount() { return session().currentCamera()->mount; }
  void set(const char* name, double value) {
    auto* spin = panel->findChild<QDoubleSpinBox*>(name);
    ASSERT_NE(spin, nullptr) << name;
    spin->setValue(value);
  }
  QWidget* panel = nullptr;
};

TEST_F(MountInWindow, FiguresAreSetAndUndoneOneByOne) {
  set("mount_x", 0.1234);
  set("mountStd_y", 1.5);
  set("mountTurn_z", -90);
  set("mountTurnStd_x", 0.02);
  ASSERT_TRUE(mount());
  const MountFigures figures = figuresOf(*mount());
  EXPECT_NEAR(figures.positionM.x, 0.1234, 1e-12);
  EXPECT_NEAR(figures.anglesRad.z, radiansFromDegrees(-90), 1e-12);
  EXPECT_NEAR(figures.positionStdM.y, 0.0015, 1e-12);
  EXPECT_NEAR(figures.anglesStdRad.x, radiansFromDegrees(0.02), 1e-12);
  session().undo().undo();
  session().undo().undo();
  EXPECT_NEAR(figuresOf(*mount()).anglesRad.z, 0, 1e-12);
  EXPECT_NEAR(panel->findChild<QDoubleSpinBox*>("mountTurn_z")->value(), 0, 1e-9);
  EXPECT_NEAR(panel->findChild<QDoubleSpinBox*>("mount_x")->value(), 0.1234, 1e-9);
  session().undo().undo();
  session().undo().undo();
  session().undo().undo();
  EXPECT_FALSE(mount());
  EXPECT_FALSE(panel->findChild<QCheckBox*>("mountOn")->isChecked());
}

TEST_F(MountInWindow, WhatIsNoMountIsToldAndChangesNothing) {
  auto* problem = panel->findChild<QLabel*>("mountProblem");
  EXPECT_TRUE(problem->isHidden());
  set("mount_y", 5000);
  EXPECT_FALSE(problem->isHidden());
  EXPECT_TRUE(problem->text().contains("5000 m")) << problem->text().toStdString();
  EXPECT_EQ(figuresOf(*mount()).positionM.y, 0);
  set("mount_y", 0.5);
  EXPECT_TRUE(problem->isHidden());
  EXPECT_NEAR(figuresOf(*mount()).positionM.y, 0.5, 1e-12);
  auto* body = panel->findChild<QComboBox*>("mountBody");
  body->lineEdit()->setText("  ");
  emit body->lineEdit()->editingFinished();
  EXPECT_FALSE(problem->isHidden());
  EXPECT_FALSE(mount()->body.empty());
}

}  // namespace alidade::test
