// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Cleaning and registering scans in the window, and taking it back.

#include <filesystem>

#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QPushButton>

#include "app/scan_cleaning.h"
#include "io/project_store.h"
#include "ui/cleaning_panel.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace fs = std::filesystem;

namespace {

/// The demo site, copied where files may be written beside it.
struct CleaningInWindow : ::testing::Test {
  void SetUp() override {
    Project demo = *loadProject(demoProject());
    path = folder.filePath("site.alidade").toStdString();
    scanFile = folder.filePath("hall.las").toStdString();
    fs::copy_file(demo.scans.at(0).source.path, scanFile);
    demo.scans[0].source = *describeSource(scanFile);
    demo.scans[0].name = "hall";
    demo.path = path;
    ASSERT_TRUE(saveProject(demo, path).has_value());
    window.resize(1400, 900);
    window.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&window));
    window.openPaths({QString::fromStdString(path)});
    ASSERT_TRUE(waitFor([this] { return session().hasProject(); }));
    ASSERT_TRUE(settle());
    window.actions()[Command::ShowCleaning]->trigger();
    panel = window.findChild<CleaningPanel*>("cleaningPanel");
    ASSERT_NE(panel, nullptr);
    ASSERT_TRUE(waitFor([this] { return panel->isVisible(); }));
  }
  void TearDown() override { session().undo().clear(), session().markSaved(path); }
  Session& session() { return window.session(); }
  bool settle() {
    return waitFor([this] { return window.settled(); });
  }
  std::uint64_t total() { return session().rendered()->frame.picture.pointsTotal; }

  QTemporaryDir folder;
  std::string path, scanFile;
  MainWindow window;
  CleaningPanel* panel = nullptr;
};

}  // namespace

TEST_F(CleaningInWindow, ThinsTheScanShowsItAndTakesItBack) {
  const std::uint64_t before = total();
  const auto bytes = fs::file_size(scanFile);
  const auto time = fs::last_write_time(scanFile);
  auto* run = window.findChild<QPushButton*>("runCleaning");
  EXPECT_FALSE(run->isEnabled()) << "nothing is ticked yet";
  window.findChild<QCheckBox*>("thinScan")->setChecked(true);
  window.findChild<QCheckBox*>("classifyGround")->setChecked(true);
  ASSERT_TRUE(run->isEnabled());
  run->click();
  EXPECT_FALSE(session().jobs().idle());
  ASSERT_TRUE(settle());
  ASSERT_EQ(session().project()->scans.size(), 2u) << window.findChild<QLabel*>("cleaningReport")->text().toStdString();
  EXPECT_FALSE(session().project()->scans[0].visible);
  const Scan& cleaned = session().project()->scans[1];
  EXPECT_EQ(cleaned.name, "hall cleaned");
  EXPECT_LT(total(), before);
  EXPECT_GT(total(), before / 10);
  EXPECT_EQ(total(), cleaned.info.pointCount);
  EXPECT_TRUE(window.findChild<QLabel*>("cleaningReport")->text().contains("ground"));
  EXPECT_EQ(fs::file_size(scanFile), bytes);
  EXPECT_EQ(fs::last_write_time(scanFile), time);

  window.actions()[Command::Undo]->trigger();
  ASSERT_TRUE(settle());
  EXPECT_EQ(session().project()->scans.size(), 1u);
  EXPECT_TRUE(session().project()->scans[0].visible);
  EXPECT_EQ(total(), before);
  window.actions()[Command::Redo]->trigger();
  ASSERT_TRUE(settle());
  EXPECT_LT(total(), before);
}

TEST_F(CleaningInWindow, MovesAScanBackOntoAnother) {
  // A copy that stands 80 mm off.
  const std::string moved = folder.filePath("moved.laz").toStdString();
  const RigidTransform shift{glm::dquat(1, 0, 0, 0), glm::dvec3(0.06, -0.05, 0.02)};
  ASSERT_TRUE(moveScan(scanFile, moved, shift, Progress()).has_value());
  window.files().add({QString::fromStdString(moved)});
  ASSERT_TRUE(waitFor([this] { return session().project()->scans.size() == 2; }));
  ASSERT_TRUE(settle());
  window.findChild<QComboBox*>("cleanedScan")->setCurrentIndex(1);
  window.findChild<QComboBox*>("fixedScan")->setCurrentIndex(0);
  window.actions()[Command::RegisterScan]->trigger();
  ASSERT_TRUE(settle());
  const QString report = window.findChild<QLabel*>("cleaningReport")->text();
  ASSERT_EQ(session().project()->scans.size(), 3u) << report.toStdString();
  EXPECT_FALSE(session().project()->scans[1].visible);
  const Bounds fixed = session().data()->scans.at(session().project()->scans[0].id)[0].points.store->bounds();
  const Bounds fitted = session().data()->scans.at(session().project()->scans[2].id)[0].points.store->bounds();
  EXPECT_LT(glm::length(fitted.centre() - fixed.centre()), 0.005);
  EXPECT_TRUE(report.contains("mm")) << report.toStdString();
  window.actions()[Command::Undo]->trigger();
  EXPECT_EQ(session().project()->scans.size(), 2u);
  EXPECT_TRUE(session().project()->scans[1].visible);
}

TEST_F(CleaningInWindow, ACancelledCleaningChangesNothing) {
  window.findChild<QCheckBox*>("dropOutliers")->setChecked(true);
  window.actions()[Command::CleanScan]->trigger();
  ASSERT_FALSE(session().jobs().idle());
  session().jobs().cancelAll();
  ASSERT_TRUE(settle());
  EXPECT_EQ(session().project()->scans.size(), 1u);
  EXPECT_FALSE(session().undo().canUndo());
  EXPECT_FALSE(fs::exists(folder.filePath("hall cleaned.laz").toStdString()));
}

}  // namespace alidade::test
