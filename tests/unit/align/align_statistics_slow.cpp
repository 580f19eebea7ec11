// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Random starts on the sample site and on real data: how often the alignment finds the pose, how near it comes, and
// that it never believes a wrong one.

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/auto_align.h"
#include "app/jobs.h"
#include "io/project_store.h"
#include "unit/align/rendered_house.h"
#include "unit/align/starts.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;
using test::StartStatistics;

int startCount() {
  const char* given = std::getenv("ALIDADE_ALIGN_STARTS");
  return given ? std::atoi(given) : 100;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

StartStatistics run(const Project& project, const LoadedData& data, const char* name, int frameStep, double believedPx,
                    AlignTo to = AlignTo::Scans) {
  const AlignmentScene scene = alignmentScene(project, data, to);
  PictureCache pictures;
  std::mt19937 random(7);
  StartStatistics s;
  std::vector<FrameId> frames;
  for (std::size_t i = 0; i < project.frames.size(); i += static_cast<std::size_t>(frameStep)) frames.push_back(project.frames[i].id);
  const int starts = startCount();
  for (int i = 0; i < starts; ++i) {
    Project copy = project;
    Frame& frame = *copy.findFrame(frames[static_cast<std::size_t>(i) * frames.size() / static_cast<std::size_t>(starts)]);
    const RigidTransform truth = *frame.cameraFromWorld;
    const Camera& camera = copy.findCamera(frame.camera)->camera;
    const Camera small = camera.scaledTo(240, std::max(1, 240 * camera.height() / camera.width()));
    const DepthImage depth = drawScanView(scene, small, truth).depth;
    const double scale = std::min(1920, camera.width()) / 240.0;
    frame.cameraFromWorld = test::disturbed(truth, random);
    const auto before = test::poseError(depth, small, scale, truth, *frame.cameraFromWorld);
    const double cpu = test::cpuSeconds();
    const auto summary = autoAlignFrame(copy, scene, pictures, frame.id, {}, false, {});
    s.cpuSecs.push_back(test::cpuSeconds() - cpu);
    ++s.starts;
    if (!summary) {
      ADD_FAILURE() << summary.error().text();
      continue;
    }
    const auto after = test::poseError(depth, small, scale, truth, *frame.cameraFromWorld);
    if (std::getenv("ALIDADE_ALIGN_VERBOSE")) {
      const AlignmentEvidence& e = summary->evidence;
      std::printf("  %3d %-14s start %6.1f px: %s %5.2f px %5.1f mm conf %.2f  %d/%d/%d corr %.2f spread %.2f exp %.2f halves %.2f nid %.3f/%.3f rival %.2f aside %.2f scale %.1f cpu %.2f  %s\n",
                  i, frame.name.c_str(), before.medianPx, summary->converged ? "conv" : "  no", after.medianPx, after.mmAt10m, summary->confidence,
                  e.inliers, e.matched, e.patches, e.correlation, e.spread, e.expectedPx, e.halvesPx, e.information, e.informationAside,
                  e.rivalScore, e.asideScore, summary->levelScale, s.cpuSecs.back(), summary->reason.c_str());
    }
    if (!summary->converged) continue;
    ++s.converged;
    s.px.push_back(after.medianPx), s.mm.push_back(after.mmAt10m);
    if (after.medianPx <= 1) ++s.within;
    if (after.medianPx > believedPx) ++s.wrong;
  }
  std::printf("%s: %d starts, %d converged, %d within 1 px, %d wrong; median %.2f px, 95 %% %.2f px, worst %.2f px; at 10 m median %.1f mm, 95 %% %.1f mm; CPU median %.2f s, worst %.2f s\n",
              name, s.starts, s.converged, s.within, s.wrong, percentile(s.px, 0.5), percentile(s.px, 0.95), percentile(s.px, 1),
              percentile(s.mm, 0.5), percentile(s.mm, 0.95), percentile(s.cpuSecs, 0.5), percentile(s.cpuSecs, 1));
  return s;
}

}  // namespace

TEST(AutoAlignStatistics, DemoSite) {
  const char* given = std::getenv("ALIDADE_ALIGN_DEMO");
  const fs::path folder = given ? fs::path(given) : fs::temp_directory_path() / fmt::format("alidade_align_{}", getpid());
  if (!given) {
    DemoOptions options;
    options.width = 1920, options.height = 1080, options.frames = 45;
    const auto made = makeDemo(folder.string(), options, Progress());
    ASSERT_TRUE(made) << made.error().text();
  }
  const auto project = loadProject((folder / "demo.alidade").string());
  ASSERT_TRUE(project) << project.error().text();
  const auto loaded = loadData(*project, Progress());
  ASSERT_TRUE(loaded && loaded->problems.empty());
  const StartStatistics s = run(*project, loaded->data, "demo", 5, 2);
  EXPECT_GE(s.within, 95 * s.starts / 100);
  EXPECT_EQ(s.wrong, 0);
  const StartStatistics design = run(*project, loaded->data, "demo, design alone", 5, 2, AlignTo::Designs);
  EXPECT_GE(design.within, 90 * design.starts / 100);
  EXPECT_EQ(design.wrong, 0);
  if (!given) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
}

TEST(AutoAlignStatistics, IndoorVideo) {
  const fs::path data = fs::path(ALIDADE_SHARED_DATA_DIR) / "indoor_video";
  if (!fs::exists(data)) GTEST_SKIP() << "the indoor video is not here";
  NewProjectInputs inputs;
  inputs.scans = {(data / "cloud_quarter.las").string()};
  inputs.images = {(data / "images").string()};
  inputs.cameras = {(data / "sparse").string()};
  const auto made = newProject(inputs, Progress());
  ASSERT_TRUE(made) << made.error().text();
  const auto loaded = loadData(made->project, Progress());
  ASSERT_TRUE(loaded && loaded->problems.empty());
  const StartStatistics s = run(made->project, loaded->data, "indoor_video", 1, 3);
  EXPECT_EQ(s.wrong, 0);
}

TEST(AutoAlignStatistics, Road) {
  const fs::path data = fs::path(ALIDADE_SHARED_DATA_DIR) / "road";
  if (!fs::exists(data)) GTEST_SKIP() << "the road is not here";
  NewProjectInputs inputs;
  inputs.scans = {(data / "road_mesh_sampled.las").string()};
  inputs.images = {(data / "101_0367_0007.JPG").string()};
  inputs.cameras = {(data / "sparse").string()};
  const auto made = newProject(inputs, Progress());
  ASSERT_TRUE(made) << made.error().text();
  const auto loaded = loadData(made->project, Progress());
  ASSERT_TRUE(loaded && loaded->problems.empty());
  const StartStatistics s = run(made->project, loaded->data, "road", 1, 3);
  EXPECT_EQ(s.wrong, 0);
}

// What is asked of poses found by the design alone was chosen on the sample site: other houses must not fool it either.
TEST(AutoAlignStatistics, HousesByTheDesignAlone) {
  const fs::path data = fs::path(ALIDADE_SHARED_DATA_DIR) / "ifc";
  if (!fs::exists(data)) GTEST_SKIP() << "the designs are not here";
  for (const char* house : {"AC20-FZK-Haus.ifc", "duplex.ifc"}) {
    const char* given = std::getenv("ALIDADE_ALIGN_HOUSES");  // keeps the pictures
    const fs::path folder = (given ? fs::path(given) : fs::temp_directory_path() / fmt::format("alidade_house_{}", getpid())) / fs::path(house).stem();
    fs::create_directories(folder);
    const auto project = test::renderedHouse((data / house).string(), folder.string(), 5, 1280, 960);
    ASSERT_TRUE(project) << project.error().text();
    const auto loaded = loadData(*project, Progress());
    ASSERT_TRUE(loaded && loaded->problems.empty());
    const StartStatistics s = run(*project, loaded->data, house, 1, 2, AlignTo::Designs);
    EXPECT_EQ(s.wrong, 0);
    std::error_code ignored;
    if (!given) fs::remove_all(folder, ignored);
  }
}

}  // namespace alidade
