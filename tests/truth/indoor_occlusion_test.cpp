// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// A box put under the table of a real room: the table and the chairs must hide it from every camera.

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/jobs.h"
#include "io/picture_file.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;

/// A pixel of the table's top, far from its edges, in a frame that looks down on it.
constexpr const char* kTableFrame = "00374.png";
constexpr glm::dvec2 kTablePixel(130, 218);
constexpr double kBelowTableM = 0.11;  // centre of the box under the table's top
constexpr double kHalfSizeM = 0.045;

/// The mean direction that the cameras call up.
glm::dvec3 upDirection(const Project& project) {
  glm::dvec3 up(0);
  for (const Frame& frame : project.frames)
    if (frame.cameraFromWorld) up -= glm::conjugate(frame.cameraFromWorld->rotation) * glm::dvec3(0, 1, 0);
  return glm::normalize(up);
}

void writeBox(const fs::path& path, const glm::dvec3& centre) {
  std::ofstream obj(path);
  obj.precision(9);
  obj << "o box\n";
  for (int i = 0; i < 8; ++i)
    obj << "v " << centre.x + (i & 1 ? kHalfSizeM : -kHalfSizeM) << ' ' << centre.y + (i & 2 ? kHalfSizeM : -kHalfSizeM)
        << ' ' << centre.z + (i & 4 ? kHalfSizeM : -kHalfSizeM) << '\n';
  for (const auto& f : {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}})
    obj << "f " << f[0] << ' ' << f[1] << ' ' << f[2] << ' ' << f[3] << '\n';
}

}  // namespace

TEST(IndoorVideo, ABoxUnderTheTableIsHiddenInEveryFrameThatLooksAtIt) {
  const fs::path data = fs::path(ALIDADE_SHARED_DATA_DIR) / "indoor_video";
  if (!fs::exists(data)) GTEST_SKIP() << "the indoor video is not here";
  NewProjectInputs inputs;
  inputs.scans = {(data / "cloud_quarter.las").string()};
  inputs.images = {(data / "images").string()};
  inputs.cameras = {(data / "sparse").string()};
  auto made = newProject(inputs, Progress());
  ASSERT_TRUE(made) << made.error().text();
  auto loaded = loadData(made->project, Progress());
  ASSERT_TRUE(loaded && loaded->problems.empty());
  auto renderer = OverlayRenderer::create();
  ASSERT_TRUE(renderer) << renderer.error().text();
  PictureCache pictures;
  const auto tableFrame = made->project.frameByNameOrIndex(kTableFrame);
  ASSERT_TRUE(tableFrame);
  const auto seen = renderFrame(made->project, loaded->data, *tableFrame, {}, **renderer, pictures);
  ASSERT_TRUE(seen) << seen.error().text();
  const auto table = readoutAt(*seen, kTablePixel);
  ASSERT_TRUE(table.world) << "the table's top is not in the scan there";

  const fs::path box = fs::temp_directory_path() / fmt::format("alidade_box_{}.obj", getpid());
  writeBox(box, *table.world - kBelowTableM * upDirection(made->project));
  const auto withBox = addToProject(made->project, {box.string()}, Progress());
  ASSERT_TRUE(withBox) << withBox.error().text();
  const auto boxData = loadData(withBox->project, Progress());
  ASSERT_TRUE(boxData && boxData->problems.empty());

  int frames = 0;
  std::uint64_t hidden = 0, visible = 0, unknown = 0;
  for (const Frame& frame : withBox->project.frames) {
    const auto rendered = renderFrame(withBox->project, boxData->data, frame.id, {}, **renderer, pictures);
    ASSERT_TRUE(rendered) << rendered.error().text();
    if (const char* folder = std::getenv("ALIDADE_TEST_PICTURES")) {
      ASSERT_TRUE(writePng(rendered->picture.colour, (fs::path(folder) / ("indoor_" + frame.name)).string()));
    }
    if (rendered->picture.elements.empty()) continue;
    const ElementPixels& pixels = rendered->picture.elements.front();
    std::printf("%s: hidden %llu, visible %llu, unknown %llu px\n", frame.name.c_str(),
                static_cast<unsigned long long>(pixels.hidden), static_cast<unsigned long long>(pixels.visible),
                static_cast<unsigned long long>(pixels.unknown));
    EXPECT_LE(static_cast<double>(pixels.visible),
              0.02 * static_cast<double>(pixels.visible + pixels.hidden + pixels.unknown) + 20)
        << frame.name;
    ++frames;
    hidden += pixels.hidden;
    visible += pixels.visible;
    unknown += pixels.unknown;
  }
  EXPECT_GE(frames, 5);
  EXPECT_GT(hidden, 20 * visible);
  std::printf("in all: hidden %llu, visible %llu, unknown %llu px\n", static_cast<unsigned long long>(hidden),
              static_cast<unsigned long long>(visible), static_cast<unsigned long long>(unknown));
  std::error_code ignored;
  fs::remove(box, ignored);
}

}  // namespace alidade
