// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the cursor points at in a picture whose rows were read one after the other, against the simulator's depths.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/jobs.h"
#include "app/workspace.h"
#include "io/project_store.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 480, kHeight = 360;
constexpr double kReadoutSecs = 0.05;

DepthImage trueDepth(const fs::path& path) {
  DepthImage depth(kWidth, kHeight);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(depth.data()), static_cast<std::streamsize>(depth.size() * sizeof(float)));
  EXPECT_TRUE(file) << path;
  return depth;
}

/// Median distance across the ray, in metres, between what is picked and what is there, over the first and last rows.
double medianMiss(const Project& project, const RenderedFrame& frame, const Frame& its, const DepthImage& truth) {
  const PoseTrack& track = project.trajectories.front().track;
  std::vector<double> misses;
  for (int y = 8; y < kHeight - 8; y = y == 40 ? kHeight - 40 : y + 4)
    for (int x = 8; x < kWidth - 8; x += 4) {
      // From the trajectory's own pose of the row's time; the sky and edges, where a pixel tells of two things, are left out.
      const double z = truth.at(x, y);
      const bool smooth = std::abs(truth.at(x - 4, y) - z) < 0.05 * z && std::abs(truth.at(x + 4, y) - z) < 0.05 * z &&
                          std::abs(truth.at(x, y - 4) - z) < 0.05 * z && std::abs(truth.at(x, y + 4) - z) < 0.05 * z;
      if (!smooth || z > 20) continue;
      const auto pose = track.at(its.timeSecs + kReadoutSecs * (y - 0.5 * (kHeight - 1)) / kHeight).cameraFromWorld;
      const auto ray = frame.description.camera.unproject({x, y});
      const CursorReadout picked = readoutAt(frame, {x, y});
      if (!pose || !ray || !picked.world) continue;
      const glm::dvec3 inCamera = *pose * *picked.world;
      const glm::dvec3 unit = glm::normalize(*ray);
      misses.push_back(glm::length(inCamera - glm::dot(inCamera, unit) * unit));
    }
  EXPECT_GT(misses.size(), 200u);
  if (misses.empty()) return 1e9;
  std::nth_element(misses.begin(), misses.begin() + static_cast<std::ptrdiff_t>(misses.size() / 2), misses.end());
  return misses[misses.size() / 2];
}

}  // namespace

TEST(RollingShutterTruth, APickLiesOnTheRayOfItsOwnRow) {
  const fs::path folder = fs::temp_directory_path() / ("alidade_rows_" + std::to_string(getpid()));
  DemoOptions options;
  options.points = 400'000;
  options.frames = 12;
  options.width = kWidth;
  options.height = kHeight;
  options.readoutSecs = kReadoutSecs;
  const auto path = makeDemo(folder.string(), options, Progress(), true);
  ASSERT_TRUE(path) << path.error().text();
  auto project = loadProject(*path);
  ASSERT_TRUE(project) << project.error().text();
  auto loaded = loadData(*project, Progress());
  ASSERT_TRUE(loaded) << loaded.error().text();
  auto renderer = OverlayRenderer::create();
  ASSERT_TRUE(renderer) << renderer.error().text();
  PictureCache pictures;
  constexpr std::size_t kFrame = 6;
  const DepthImage truth = trueDepth(folder / "truth" / fmt::format("depth.{:04}.f32", kFrame));
  const auto missWith = [&](double readoutSecs) {
    for (CameraRecord& camera : project->cameras) camera.readoutSecs = readoutSecs;
    const Frame& frame = project->frames[kFrame];
    const auto rendered = renderFrame(*project, loaded->data, frame.id, {}, **renderer, pictures);
    EXPECT_TRUE(rendered) << rendered.error().text();
    return rendered ? medianMiss(*project, *rendered, frame, truth) : 1e9;
  };
  const double heeded = missWith(kReadoutSecs), ignored = missWith(0);
  std::printf("median miss across the ray: %.2f mm, %.2f mm where the read-out is ignored\n", 1000 * heeded, 1000 * ignored);
  EXPECT_LT(heeded, 0.003);
  EXPECT_GT(ignored, 4 * heeded);
  std::error_code none;
  fs::remove_all(folder, none);
}

}  // namespace alidade
