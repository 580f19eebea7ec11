// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// Visible and hidden on the sample inspection, pixel by pixel against the ray-cast truth.

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
#include "io/project_store.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 1280, kHeight = 960, kFrames = 3;

template <class T>
Image<T> readRaw(const fs::path& path) {
  Image<T> image(kWidth, kHeight);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(image.data()), static_cast<std::streamsize>(image.size() * sizeof(T)));
  EXPECT_TRUE(file) << path;
  return image;
}

bool isJump(float a, float b) {
  if (!std::isfinite(a) || !std::isfinite(b)) return std::isfinite(a) != std::isfinite(b);
  return std::abs(a - b) > 0.05f + 0.02f * std::min(a, b);
}

/// True where a depth edge of the world or of the design lies within two pixels.
bool nearDepthEdge(const DepthImage& world, const DepthImage& design, int x, int y) {
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const int nx = x + dx, ny = y + dy;
      if (!world.contains(nx, ny)) return true;
      if (isJump(world.at(x, y), world.at(nx, ny)) || isJump(design.at(x, y), design.at(nx, ny))) return true;
    }
  return false;
}

struct Score {
  std::uint64_t right = 0, wrong = 0, unknown = 0, missing = 0;
  std::uint64_t all() const { return right + wrong + unknown + missing; }
  double share(std::uint64_t part) const { return 100.0 * static_cast<double>(part) / static_cast<double>(all()); }
};

/// Returns the picture of it: green right, red wrongly hidden, blue wrongly visible, yellow unknown.
ColourImage compare(const OverlayPicture& ours, const Image<std::uint8_t>& truth, const DepthImage& world,
                    const DepthImage& design, Score& score) {
  ColourImage difference = ours.colour;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (truth.at(x, y) == 0 || nearDepthEdge(world, design, x, y)) continue;
      const auto wanted = truth.at(x, y) == 1 ? Visibility::Visible : Visibility::Hidden;
      const auto got = static_cast<Visibility>(ours.state.at(x, y));
      Rgba8& mark = difference.at(x, y);
      if (got == wanted) {
        ++score.right;
        mark.g = 255;
      } else if (got == Visibility::Unknown) {
        ++score.unknown;
        mark = {255, 230, 0, 255};
      } else if (got == Visibility::Outside) {
        ++score.missing;
        mark = {255, 0, 255, 255};
      } else {
        ++score.wrong;
        mark = wanted == Visibility::Visible ? Rgba8{255, 0, 0, 255} : Rgba8{0, 0, 255, 255};
      }
    }
  }
  return difference;
}

void print(const char* name, const Score& score) {
  std::printf("%s, design pixels %llu: right %.2f %%, wrong %.2f %%, unknown %.2f %%, not drawn %.2f %%\n", name,
              static_cast<unsigned long long>(score.all()), score.share(score.right), score.share(score.wrong),
              score.share(score.unknown), score.share(score.missing));
}

/// What a video that plays shows of a frame.
void comparePlayed(const Project& project, const LoadedData& data, FrameId frame, OverlayRenderer& renderer,
                   const Image<std::uint8_t>& truth, const DepthImage& world, const DepthImage& design, Score& score) {
  auto description = describeFrame(project, data, frame, nullptr);
  ASSERT_TRUE(description) << description.error().text();
  allowForPlaying(*description);
  const auto picture = renderer.render(*description);
  ASSERT_TRUE(picture) << picture.error().text();
  compare(*picture, truth, world, design, score);
}

}  // namespace

TEST(DemoSite, VisibleAndHiddenAgreeWithTheTruthForNineteenPixelsInTwenty) {
  const fs::path folder = fs::temp_directory_path() / ("alidade_truth_" + std::to_string(getpid()));
  DemoOptions options;
  options.frames = kFrames;
  options.width = kWidth;
  options.height = kHeight;
  const auto path = makeDemo(folder.string(), options, Progress());
  ASSERT_TRUE(path) << path.error().text();
  auto project = loadProject(*path);
  ASSERT_TRUE(project) << project.error().text();
  project->display.hidden = HiddenStyle::Ghost;
  auto loaded = loadData(*project, Progress());
  ASSERT_TRUE(loaded) << loaded.error().text();
  ASSERT_TRUE(loaded->problems.empty()) << loaded->problems.front().text();
  auto renderer = OverlayRenderer::create();
  ASSERT_TRUE(renderer) << renderer.error().text();

  PictureCache pictures;
  LoadedData ungridded = loaded->data;
  for (auto& [id, layers] : ungridded.scans)
    for (ScanLayer& layer : layers) layer.surface = nullptr;
  Score score, played, playedByPoints;
  for (int i = 0; i < kFrames; ++i) {
    const auto rendered = renderFrame(*project, loaded->data, project->frames[i].id, {}, **renderer, pictures);
    ASSERT_TRUE(rendered) << rendered.error().text();
    const fs::path truth = folder / "truth";
    const auto visibility = readRaw<std::uint8_t>(truth / fmt::format("visibility.{:04}.u8", i));
    const auto world = readRaw<float>(truth / fmt::format("depth.{:04}.f32", i));
    const auto design = readRaw<float>(truth / fmt::format("designdepth.{:04}.f32", i));
    const ColourImage difference = compare(rendered->picture, visibility, world, design, score);
    comparePlayed(*project, loaded->data, project->frames[i].id, **renderer, visibility, world, design, played);
    comparePlayed(*project, ungridded, project->frames[i].id, **renderer, visibility, world, design, playedByPoints);
    if (const char* pictureFolder = std::getenv("ALIDADE_TEST_PICTURES")) {
      ASSERT_TRUE(writePng(difference, (fs::path(pictureFolder) / fmt::format("visibility_{}.png", i)).string()));
    }
  }
  print("still", score);
  print("played", played);
  print("played, a scan without grid", playedByPoints);
  EXPECT_GT(score.all(), 50'000u);
  EXPECT_GE(score.share(score.right), 95.0);
  EXPECT_GE(played.share(played.right), 94.0);
  EXPECT_GE(playedByPoints.share(playedByPoints.right), 93.5);
  std::error_code ignored;
  fs::remove_all(folder, ignored);
}

}  // namespace alidade
