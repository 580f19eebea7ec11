// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// A large raw scan: its first picture, the whole, and what a cancel leaves.

#include <QToolButton>

#include "io/project_store.h"
#include "io/reader_registry.h"
#include "ui/window_fixture.h"

namespace alidade::test {

namespace {

constexpr std::uint64_t kPoints = 2'400'000;

/// The demo site with a floor of many points about its first camera instead of its scan.
std::string projectWithLargeScan() {
  static const QTemporaryDir folder;
  static const std::string path = [] {
    const std::string scan = folder.filePath("floor.las").toStdString();
    auto project = *loadProject(demoProject());
    const auto posed = std::ranges::find_if(project.frames, [](const Frame& f) { return f.cameraFromWorld.has_value(); });
    const glm::dvec3 middle = glm::round(posed->cameraFromWorld->centre()) - glm::dvec3(0, 0, 2);
    ScanWriteOptions options;
    options.info.scale = glm::dvec3(0.001);
    options.info.offset = middle;
    auto sink = (*ReaderRegistry::instance().findWriter(scan))->create(scan, options);
    constexpr int kSide = 1600;
    for (int row = 0; row < static_cast<int>(kPoints / kSide); row += 100) {
      PointBatch batch;
      for (int i = 0; i < 100 * kSide; ++i)
        batch.position.push_back(middle + glm::dvec3(0.02 * (i % kSide - kSide / 2), 0.02 * (row + i / kSide - 750), 0));
      if (!(*sink)->add(batch, std::nullopt)) return std::string("failed");
    }
    if (!(*sink)->finish()) return std::string("failed");
    project.designs.clear();
    project.scans.resize(1);
    project.scans[0].source = *describeSource(scan);
    project.scans[0].info = *(*ReaderRegistry::instance().findAs<ScanReader>(scan))->inspect(scan);
    const std::string made = folder.filePath("large.alidade").toStdString();
    project.path = made;
    return saveProject(project, made) ? made : std::string("failed");
  }();
  return path;
}

struct LargeScan : ::testing::Test {
  void SetUp() override {
    ASSERT_TRUE(projectWithLargeScan().ends_with(".alidade"));
    window.resize(1000, 700);
    window.show();
    ASSERT_TRUE(QTest::qWaitForWindowExposed(&window));
    QObject::connect(&session(), &Session::pictureReady, &window, [this](const std::shared_ptr<const RenderResult>& result) {
      for (const ScanLayer& layer : result->frame.description.scans) pictures.push_back(layer);
    });
    window.openPaths({QString::fromStdString(projectWithLargeScan())});
  }
  Session& session() { return window.session(); }
  MainWindow window;
  std::vector<ScanLayer> pictures;  ///< the scan as each picture had it
};

}  // namespace

TEST_F(LargeScan, ShowsASampleBeforeTheWhole) {
  ASSERT_TRUE(waitFor([this] { return !pictures.empty(); }));
  const ScanLayer first = pictures.front();
  EXPECT_EQ(first.sampleOf, kPoints);
  EXPECT_GT(first.points.store->pointCount(), 10'000u);
  EXPECT_LT(first.points.store->pointCount(), 1'000'000u);
  EXPECT_FALSE(session().jobs().idle());
  EXPECT_EQ(session().rendered()->frame.picture.pointsTotal, kPoints);
  ASSERT_TRUE(waitFor([this] { return window.settled(); }));
  EXPECT_EQ(pictures.back().sampleOf, 0u);
  EXPECT_EQ(pictures.back().points.store->pointCount(), kPoints);
}

TEST_F(LargeScan, ACancelledLoadLeavesNoSampleBehind) {
  ASSERT_TRUE(waitFor([this] { return !pictures.empty(); }));
  ASSERT_FALSE(session().jobs().idle());
  auto* cancel = window.findChild<QToolButton*>("cancelJob");
  ASSERT_NE(cancel, nullptr);
  cancel->click();
  ASSERT_TRUE(waitFor([this] { return window.settled(); }));
  EXPECT_TRUE(session().data()->scans.empty());
}

}  // namespace alidade::test
