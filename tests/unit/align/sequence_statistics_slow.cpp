// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/jobs.h"
#include "app/refine_sequence.h"
#include "io/picture_file.h"
#include "io/project_store.h"
#include "simulate/camera_path.h"
#include "simulate/frame_renderer.h"
#include "unit/align/starts.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;

int keyframeCount() {
  const char* given = std::getenv("ALIDADE_ALIGN_STARTS");
  return std::clamp(given ? std::atoi(given) : 60, 2, 600);
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

}  // namespace

// Ten minutes of the walk, a keyframe every ten seconds, rendered and decoded as in any project; the poses drift by a
// wander of up to half a metre and two degrees.
TEST(SequenceStatistics, TenMinutesOfVideoWithDrift) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("alidade_drift_{}", getpid());
  DemoOptions options;
  options.frames = 1, options.points = 2'000'000, options.truth = false;
  const auto made = makeDemo(folder.string(), options, Progress());
  ASSERT_TRUE(made) << made.error().text();
  auto project = loadProject((folder / "demo.alidade").string());
  ASSERT_TRUE(project) << project.error().text();
  const auto loaded = loadData(*project, Progress());
  ASSERT_TRUE(loaded && loaded->problems.empty());
  const AlignmentScene scene = alignmentScene(*project, loaded->data, AlignTo::Scans);

  const SiteModel site = makeSite(options.seed, options.siteOrigin);
  const auto built = RayScene::make(site.asBuilt), design = RayScene::make(site.design);
  ASSERT_TRUE(built && design);
  const Lighting lighting(*built);
  const Camera camera(demoIntrinsics(960, 720));
  const FrameRenderer renderer(camera, *built, *design, lighting, options.seed, true);
  constexpr int kSeconds = 600;
  const int step = static_cast<int>(kFramesPerSecond) * kSeconds / keyframeCount();
  const std::vector<RigidTransform> walk = walkPast(static_cast<int>(kFramesPerSecond) * kSeconds, options.seed);
  project->frames.clear();
  project->cameras[0].camera = camera;
  std::vector<RigidTransform> truth;
  for (std::size_t i = 0; i < walk.size(); i += static_cast<std::size_t>(step)) {
    truth.push_back(walk[i] * site.worldFromSite.inverse());
    const double t = static_cast<double>(i) / static_cast<double>(walk.size());
    const glm::dvec3 off(0.5 * t, 0.15 * std::sin(9 * t), -0.2 * t * t), turn(0.035 * t, 0.015 * std::sin(7 * t), 0.01 * t);
    Frame frame;
    frame.id = FrameId{static_cast<decltype(frame.id.value)>(truth.size())};
    frame.name = fmt::format("drift_{:04}.png", truth.size()), frame.camera = project->cameras[0].id;
    frame.timeSecs = static_cast<double>(i) / kFramesPerSecond;
    frame.image.path = (folder / frame.name).string();
    RigidTransform said = truth.back();
    if (const double angle = glm::length(turn); angle > 0) said.rotation = glm::normalize(glm::angleAxis(angle, turn / angle) * said.rotation);
    said.translation = -(said.rotation * (truth.back().centre() + off));
    frame.cameraFromWorld = said;
    FrameTruth ignored;
    ASSERT_TRUE(writePng(renderer.render({walk[i]}, static_cast<int>(i), ignored), frame.image.path));
    project->frames.push_back(frame);
  }
  PictureCache pictures;
  const double cpu = test::cpuSeconds();
  const auto summary = refineSequence(*project, scene, pictures, {}, false, Progress());
  ASSERT_TRUE(summary) << summary.error().text();
  EXPECT_TRUE(summary->converged) << summary->report(*project);
  std::vector<double> before, after;
  const Camera small = camera.scaledTo(240, 180);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const DepthImage depth = drawScanView(scene, small, truth[i]).depth;
    before.push_back(test::poseError(depth, small, 4, truth[i], summary->frames[i].before).medianPx);
    after.push_back(test::poseError(depth, small, 4, truth[i], *project->frames[i].cameraFromWorld).medianPx);
  }
  std::printf("drift: %zu keyframes over %d s, before median %.1f px, worst %.1f px; after median %.2f px, worst %.2f px; sigma naught %.2f; CPU %.1f s a frame\n",
              truth.size(), kSeconds, percentile(before, 0.5), percentile(before, 1), percentile(after, 0.5), percentile(after, 1),
              summary->adjustment.sigma0, (test::cpuSeconds() - cpu) / static_cast<double>(truth.size()));
  EXPECT_LE(percentile(after, 0.5), 1);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

}  // namespace alidade
