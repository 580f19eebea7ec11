// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <QGuiApplication>
#include <benchmark/benchmark.h>

#include "app/jobs.h"
#include "app/play_schedule.h"
#include "app/workspace.h"
#include "bench/site.h"
#include "io/project_store.h"

namespace alidade {
namespace {

/// A 1080p H.264 video of the sample site with its scan and design: that of ALIDADE_BENCH_VIDEO (a project file), else made
/// once, kept in ALIDADE_BENCH_FOLDER or the system's temporary folder.
struct VideoSite {
  Project project;
  LoadedData data;
};

/// A dozen frames are filmed, which takes half a minute, and the video walks over them forth and back.
constexpr int kFilmed = 12, kVideoFrames = 90;
constexpr double kRate = 15;

Result<Project> makeWalk(const std::filesystem::path& folder) {
  const std::string path = (folder / "demo.alidade").string(), video = (folder / "walk.mp4").string();
  if (!std::filesystem::exists(path)) {
    DemoOptions options;
    options.frames = kFilmed;
    options.width = 1920;
    options.height = 1080;
    options.truth = false;
    if (auto made = makeDemo(folder.string(), options, Progress(), false); !made) return fail(made.error());
  }
  auto project = loadProject(path);
  if (!project) return fail(project.error());
  std::vector<Frame> frames;
  std::vector<std::string> pictures;
  for (int i = 0; i < kVideoFrames; ++i) {
    const int turn = i % (2 * kFilmed - 2);
    Frame frame = project->frames[static_cast<std::size_t>(std::min(turn, 2 * kFilmed - 2 - turn))];
    pictures.push_back(frame.image.path);
    frame.id.value = static_cast<std::uint32_t>(i + 1);
    frame.timeSecs = i / kRate;
    frame.image = {};
    frame.video.value = 1;
    frame.videoFrame = i;
    frames.push_back(std::move(frame));
  }
  if (!std::filesystem::exists(video))
    if (auto written = encodeVideo(pictures, video, kRate, Progress()); !written) return fail(written.error());
  project->frames = std::move(frames);
  Video walk;
  walk.id.value = 1;
  walk.source.path = video;
  walk.framesPerSecond = kRate;
  walk.frameCount = kVideoFrames;
  project->videos = {walk};
  return project;
}

/// Project files need one, and so do the letters of labels.
void startQt() {
  static char name[] = "alidade-bench";
  static char* arguments[] = {name, nullptr};
  static int count = 1;
  qputenv("QT_QPA_PLATFORM", "offscreen");
  static const QGuiApplication application(count, arguments);
}

Result<VideoSite> loadSite() {
  startQt();
  const char* given = std::getenv("ALIDADE_BENCH_VIDEO");
  const char* kept = std::getenv("ALIDADE_BENCH_FOLDER");
  const auto folder = kept ? std::filesystem::path(kept) : std::filesystem::temp_directory_path() / "alidade-bench";
  auto project = given ? loadProject(given) : makeWalk(folder / "video");
  if (!project) return fail(project.error());
  auto loaded = loadData(*project, Progress());
  if (!loaded) return fail(loaded.error());
  if (!loaded->problems.empty()) return fail(loaded->problems.front());
  return VideoSite{std::move(*project), std::move(loaded->data)};
}

const Result<VideoSite>& site() {
  static const Result<VideoSite> made = loadSite();
  return made;
}

/// Draws a frame as the window does while playing.
Result<OverlayPicture> drawPlayed(const VideoSite& site, const Frame& frame, OverlayRenderer& renderer, PictureCache& pictures,
                                  bool playing) {
  auto picture = pictures.picture(site.project, frame);
  if (!picture) return fail(picture.error());
  auto description = describeFrame(site.project, site.data, frame.id, *picture);
  if (!description) return fail(description.error());
  if (playing) allowForPlaying(*description);
  return renderer.render(*description);
}

using Clock = std::chrono::steady_clock;
double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Plays the video by its own clock, decoding and drawing ahead as the window does, and counts.
void video1080pOverlay(benchmark::State& state) {
  const auto& made = site();
  if (!made) return state.SkipWithError(made.error().text().c_str());
  auto renderer = OverlayRenderer::create();
  if (!renderer) return state.SkipWithError(renderer.error().text().c_str());
  std::vector<double> secs;
  for (const Frame& frame : made->project.frames) secs.push_back(frame.timeSecs);
  double shown = 0, dropped = 0, perSecond = 0, cpu = 0, drawn = 0;
  for (auto _ : state) {
    PictureCache pictures(12);
    PlaySchedule schedule;
    const auto start = Clock::now();
    const double cpuBefore = test::cpuSeconds();
    schedule.begin(secs, -1, 1.0, 0.0);
    while (!schedule.finished()) {
      while (schedule.takeDue(secondsSince(start))) {
      }
      const auto order = schedule.order(secondsSince(start));
      if (!order) {
        const double due = schedule.nextDue().value_or(0) - secondsSince(start);
        std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, due)));
        continue;
      }
      std::vector<FrameId> next;
      for (const int i : order->next) next.push_back(made->project.frames[static_cast<std::size_t>(i)].id);
      pictures.expect(made->project, next);
      auto picture = drawPlayed(*made, made->project.frames[static_cast<std::size_t>(order->frame)], **renderer, pictures, true);
      if (!picture) return state.SkipWithError(picture.error().text().c_str());
      schedule.drawn();
      ++drawn;
    }
    cpu += test::cpuSeconds() - cpuBefore;
    shown += schedule.shown();
    dropped += schedule.dropped();
    perSecond += schedule.shownPerSecond(secondsSince(start));
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["frames_per_second"] = perSecond / runs;
  state.counters["dropped"] = dropped / runs;
  state.counters["shown"] = shown / runs;
  state.counters["cpu_ms_per_frame"] = 1000 * cpu / std::max(1.0, drawn);
  state.SetItemsProcessed(static_cast<std::int64_t>(shown));
}

/// As fast as it goes: what a frame costs. As played, or as a still picture.
void videoFrame(benchmark::State& state, bool playing) {
  const auto& made = site();
  if (!made) return state.SkipWithError(made.error().text().c_str());
  auto renderer = OverlayRenderer::create();
  if (!renderer) return state.SkipWithError(renderer.error().text().c_str());
  PictureCache pictures(12);
  const auto& frames = made->project.frames;
  std::size_t at = 0;
  const double cpuBefore = test::cpuSeconds();
  for (auto _ : state) {
    std::vector<FrameId> next;
    for (std::size_t i = 1; i <= 4 && at + i < frames.size(); ++i) next.push_back(frames[at + i].id);
    pictures.expect(made->project, next);
    auto picture = drawPlayed(*made, frames[at], **renderer, pictures, playing);
    if (!picture) return state.SkipWithError(picture.error().text().c_str());
    benchmark::DoNotOptimize(picture->colour.data());
    at = (at + 1) % frames.size();
  }
  state.counters["cpu_ms_per_frame"] = 1000 * (test::cpuSeconds() - cpuBefore) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(state.iterations());
}

/// Decoding alone, on the decoder's own thread.
void videoDecode(benchmark::State& state) {
  const auto& made = site();
  if (!made) return state.SkipWithError(made.error().text().c_str());
  PictureCache pictures(12);
  const auto& frames = made->project.frames;
  std::size_t at = 0;
  const double cpuBefore = test::cpuSeconds();
  for (auto _ : state) {
    const auto picture = pictures.picture(made->project, frames[at]);
    if (!picture) return state.SkipWithError(picture.error().text().c_str());
    at = (at + 1) % frames.size();
  }
  state.counters["cpu_ms_per_frame"] = 1000 * (test::cpuSeconds() - cpuBefore) / static_cast<double>(state.iterations());
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(video1080pOverlay)->Name("video_1080p_overlay")->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(1);
BENCHMARK_CAPTURE(videoFrame, played, true)->Name("video_1080p_frame/played")->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(60);
BENCHMARK_CAPTURE(videoFrame, still, false)->Name("video_1080p_frame/still")->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(30);
BENCHMARK(videoDecode)->Name("video_1080p_decode")->Unit(benchmark::kMillisecond)->UseRealTime()->Iterations(80);

}  // namespace
}  // namespace alidade
