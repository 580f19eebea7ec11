// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include <fmt/format.h>

#include "app/clock_estimation.h"
#include "app/frame_times.h"
#include "app/pose_clock.h"
#include "cli/command.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string project, trajectory, times;
  std::optional<double> offset, start, rate, readoutMs;
  double range = 1.0;
  bool estimate = false, dryRun = false;
};

Json jsonOf(const Trajectory& trajectory) {
  const auto& samples = trajectory.track.samples();
  const auto& std = trajectory.clockOffsetStdSecs;
  return {{"trajectory", trajectory.name},
          {"poses", samples.size()},
          {"start_s", samples.empty() ? Json(nullptr) : Json(samples.front().timeSecs)},
          {"end_s", samples.empty() ? Json(nullptr) : Json(samples.back().timeSecs)},
          {"clock_offset_s", trajectory.clockOffsetSecs},
          {"clock_offset_std_s", std ? Json(*std) : Json(nullptr)}};
}

Json jsonOf(const ClockOffset& estimate) {
  return {{"found", estimate.found},   {"offset_s", estimate.offsetSecs}, {"std_s", estimate.stdSecs},
          {"rms_px", estimate.rmsPx},  {"fitting", estimate.fitting},     {"pairs", estimate.pairs},
          {"tracks", estimate.tracks}, {"reason", estimate.reason}};
}

std::string textOf(const Trajectory& trajectory) {
  // Rounded, and a negative nothing made a nothing.
  std::string text = fmt::format("{}: clock offset {:+.4f} s", trajectory.name, std::round(trajectory.clockOffsetSecs * 1e4) / 1e4 + 0.0);
  if (trajectory.clockOffsetStdSecs) text += fmt::format(" ± {:.4f} s", *trajectory.clockOffsetStdSecs);
  return text + " (pose clock minus picture clock)\n";
}

/// Times first: an offset refers to them.
Result<bool> applyTimes(Project& project, const Arguments& arguments) {
  if (project.videos.size() > 1 && (arguments.rate || !arguments.times.empty()))
    return fail("The project has several videos", arguments.project, "Give times in a project of one video");
  const VideoId video = project.videos.empty() ? VideoId{} : project.videos.front().id;
  if (!arguments.times.empty()) {
    const auto times = readFrameTimes(arguments.times);
    if (!times) return fail(times.error());
    if (auto done = setFrameTimes(project, video, *times); !done) return fail(done.error());
  } else if (arguments.rate) {
    if (auto done = setFrameRate(project, video, *arguments.rate, arguments.start.value_or(0)); !done) return fail(done.error());
  }
  if (arguments.readoutMs)
    for (CameraRecord& camera : project.cameras) camera.readoutSecs = *arguments.readoutMs / 1000;
  return arguments.rate || !arguments.times.empty() || arguments.readoutMs;
}

Result<Answer> run(const Arguments& arguments, const Progress& progress) {
  auto project = loadProject(arguments.project);
  if (!project) return fail(project.error());
  auto changed = applyTimes(*project, arguments);
  if (!changed) return fail(changed.error());
  Answer answer;
  answer.json = Json::object();
  const bool needsTrajectory = arguments.offset || arguments.estimate || !arguments.trajectory.empty();
  if (needsTrajectory || !project->trajectories.empty()) {
    const auto id = trajectoryByName(*project, arguments.trajectory);
    if (!id) return fail(id.error());
    PoseCount count = poseFromTrajectory(*project, *id);
    if (arguments.offset) {
      auto set = setClockOffset(*project, *id, *arguments.offset);
      if (!set) return fail(set.error());
      count = *set, *changed = true;
    }
    if (arguments.estimate) {
      PictureCache pictures(16);
      ClockEstimationOptions options;
      options.search.rangeSecs = arguments.range;
      const auto estimate = estimateClock(*project, *id, options, pictures, progress);
      if (!estimate) return fail(estimate.error());
      answer.text = estimate->report() + "\n";
      answer.failed = !estimate->found;
      if (estimate->found) count = *setClockOffset(*project, *id, estimate->offsetSecs, estimate->stdSecs), *changed = true;
      answer.json["estimate"] = jsonOf(*estimate);
    }
    const Trajectory& trajectory = *project->findTrajectory(*id);
    answer.json.update(jsonOf(trajectory));
    answer.json["frames_posed"] = count.posed;
    answer.text += textOf(trajectory) + poseCountText(count) + "\n";
  }
  for (const CameraRecord& camera : project->cameras) {
    answer.json["readout_s"][camera.name] = camera.readoutSecs;
    if (camera.readoutSecs != 0) answer.text += fmt::format("{}: rows are read in {:.3f} ms\n", camera.name, 1000 * camera.readoutSecs);
  }
  if (answer.text.empty()) answer.text = "The project has no trajectory\n";
  answer.json["saved"] = *changed && !arguments.dryRun;
  if (*changed && !arguments.dryRun)
    if (auto saved = saveProject(*project, arguments.project); !saved) return fail(saved.error());
  return answer;
}

}  // namespace

void addClock(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("clock", "Show, set or estimate how pictures and poses agree in time",
                                [arguments](const Progress& progress) { return run(*arguments, progress); });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("--trajectory", arguments->trajectory, "Name, where the project has several");
  auto* offset = command->add_option("--offset", arguments->offset, "Pose clock minus picture clock, seconds")->check(finiteNumber());
  auto* estimate = command->add_flag("--estimate", arguments->estimate, "Find the offset from what moves in the pictures");
  offset->excludes(estimate);
  command->add_option("--range", arguments->range, "Seconds to either side that --estimate searches")->check(numberWithin(0.05, 3600.0))->capture_default_str();
  auto* times = command->add_option("--times", arguments->times, "Table of the frames' times: time, or name,time a line");
  auto* rate = command->add_option("--rate", arguments->rate, "Frames a second, instead of the times that the video has")->check(numberWithin(0.001, 100'000.0));
  times->excludes(rate);
  command->add_option("--start", arguments->start, "Time of the first frame with --rate, seconds")->needs(rate)->check(finiteNumber());
  command->add_option("--readout", arguments->readoutMs, "Milliseconds that the cameras take to read their rows (rolling shutter); 0: all at once")
      ->check(numberWithin(-200.0, 200.0));
  command->add_flag("--dry-run", arguments->dryRun, "Report only; leave the project as it is");
}

}  // namespace alidade::cli
