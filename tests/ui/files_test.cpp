// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include <QDropEvent>
#include <QFileInfo>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>

#include "io/project_store.h"
#include "ui/project_files.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace fs = std::filesystem;

namespace {

void drop(MainWindow& window, const std::vector<std::string>& paths) {
  QMimeData data;
  QList<QUrl> urls;
  for (const auto& path : paths) urls << QUrl::fromLocalFile(QString::fromStdString(path));
  data.setUrls(urls);
  QDragEnterEvent enter({200, 200}, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(&window, &enter);
  QDropEvent event({200.0, 200.0}, Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(&window, &event);
}

struct EmptyWindow : ::testing::Test {
  void SetUp() override {
    window.resize(1400, 900);
    window.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&window));
  }
  bool settle(int timeoutMs = 60'000) {
    return waitFor([this] { return window.settled(); }, timeoutMs);
  }
  QTemporaryDir folder;
  MainWindow window;
};

}  // namespace

TEST_F(EmptyWindow, StartsWithTheWelcomePage) {
  EXPECT_TRUE(window.findChild<QWidget*>("welcomePage")->isVisible());
  EXPECT_TRUE(window.findChild<QPushButton*>("openSampleButton")->isVisible());
  EXPECT_FALSE(window.findChild<QWidget*>("timeline")->isVisible());
}

TEST_F(EmptyWindow, AScanPicturesAndADesignDroppedTogetherMakeAProject) {
  Result<Project> demo = loadProject(demoProject());
  ASSERT_TRUE(demo.has_value()) << demo.error().text();
  std::vector<std::string> paths{demo->scans.at(0).source.path, demo->designs.at(0).source.path,
                                 fs::path(demo->frames.at(0).image.path).parent_path().string()};
  drop(window, paths);
  ASSERT_TRUE(waitFor([&] { return window.session().hasProject(); }));
  ASSERT_TRUE(settle());
  const Project& project = *window.session().project();
  EXPECT_EQ(project.scans.size(), 1u);
  EXPECT_EQ(project.designs.size(), 1u);
  EXPECT_EQ(project.frames.size(), demo->frames.size());
  EXPECT_FALSE(window.session().data()->scans.empty());
  // Pictures without cameras cannot carry the design: a note says what to do, with a button.
  bool nextStep = false;
  for (const Message& message : window.session().messages().messages())
    nextStep = nextStep || (message.severity == Severity::Note && message.action);
  EXPECT_TRUE(nextStep);
  window.session().markSaved("");
}

TEST_F(EmptyWindow, AFileThatIsNoProjectIsRefusedInASentence) {
  const QString path = folder.filePath("broken.alidade");
  QFile file(path);
  ASSERT_TRUE(file.open(QIODevice::WriteOnly));
  file.write("this is no database");
  file.close();
  window.openPaths({path});
  ASSERT_TRUE(waitFor([&] { return window.session().jobs().idle(); }));
  EXPECT_FALSE(window.session().hasProject());
  ASSERT_FALSE(window.session().messages().messages().empty());
  const Message& message = window.session().messages().messages().back();
  EXPECT_EQ(message.severity, Severity::Error);
  EXPECT_TRUE(message.fullText().contains("broken.alidade")) << message.fullText().toStdString();
}

TEST_F(EmptyWindow, OpensTheRoad) {
  const fs::path road = fs::path(ALIDADE_SHARED_DATA_DIR) / "road";
  if (!fs::exists(road / "road.ifc")) GTEST_SKIP() << "THE ROAD DATA IS ABSENT: " << road;
  window.openPaths({QString::fromStdString((road / "road.ifc").string()),
                    QString::fromStdString((road / "sparse").string()),
                    QString::fromStdString((road / "101_0367_0007.JPG").string()),
                    QString::fromStdString((road / "road_mesh_sampled.las").string())});
  ASSERT_TRUE(waitFor([&] { return window.session().hasProject(); }, 180'000));
  ASSERT_TRUE(settle(300'000));
  const auto& rendered = window.session().rendered();
  ASSERT_NE(rendered, nullptr);
  ASSERT_FALSE(rendered->problem.has_value()) << rendered->problem->text();
  EXPECT_EQ(window.overlay().probe().rawWidth(), 5472);
  EXPECT_FALSE(rendered->frame.picture.elements.empty());
  EXPECT_LE(rendered->frame.picture.worstErrorPx, 0.1);
  window.session().markSaved("");
}

TEST_F(OpenWindow, SaveInTheCloseQuestionSavesAndThenCloses) {
  const QString path = folder.filePath("copy.alidade");
  window->findChild<ProjectFiles*>()->saveAs(path);
  ASSERT_TRUE(waitFor([&] { return QFileInfo::exists(path) && window->session().jobs().idle(); }));
  session().change("Rename", [](Project& project) { project.name = "Renamed"; });
  ASSERT_TRUE(session().workUnsaved());
  QTimer::singleShot(0, window.get(), [] {
    auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
    ASSERT_NE(box, nullptr);
    box->button(QMessageBox::Save)->click();
  });
  window->close();
  ASSERT_TRUE(waitFor([&] { return !window->isVisible(); }));
  const auto saved = loadProject(path.toStdString());
  ASSERT_TRUE(saved) << saved.error().text();
  EXPECT_EQ(saved->name, "Renamed");
}

TEST_F(OpenWindow, CancelInTheCloseQuestionKeepsTheWindowAndTheWork) {
  session().change("Rename", [](Project& project) { project.name = "Renamed"; });
  QTimer::singleShot(0, window.get(), [] {
    auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
    ASSERT_NE(box, nullptr);
    box->button(QMessageBox::Cancel)->click();
  });
  window->close();
  EXPECT_TRUE(window->isVisible());
  EXPECT_TRUE(session().workUnsaved());
  session().markSaved(session().project()->path);
}

}  // namespace alidade::test
