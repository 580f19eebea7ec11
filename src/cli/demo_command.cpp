// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"

namespace alidade::cli {

void addDemo(Verbs& verbs) {
  struct Arguments {
    std::string folder;
    DemoOptions options;
    bool gray = false, video = false;
    double readoutMs = 0;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add(
      "demo", "Make the sample inspection: site, scan, video, design, defects and their truth",
      [arguments](const Progress& progress) -> Result<Answer> {
        arguments->options.colour = !arguments->gray;
        arguments->options.readoutSecs = arguments->readoutMs / 1000;
        auto project = makeDemo(arguments->folder, arguments->options, progress, arguments->video);
        if (!project) return fail(project.error());
        Answer answer;
        answer.json = {{"project", *project},
                       {"points", arguments->options.points},
                       {"frames", arguments->options.frames},
                       {"seed", arguments->options.seed}};
        answer.text = fmt::format("The sample inspection is {}\n", *project);
        return answer;
      });
  command->add_option("dir", arguments->folder, "Folder to write it to")->required();
  command->add_option("--points", arguments->options.points, "Points of the scan")
      ->check(CLI::Range(std::uint64_t{100}, std::uint64_t{10'000'000'000}))->capture_default_str();
  command->add_option("--frames", arguments->options.frames, "Frames of the video, at 15 Hz")
      ->check(CLI::Range(1, 100'000))->capture_default_str();
  command->add_option("--seed", arguments->options.seed, "Same seed, same bytes")->capture_default_str();
  command->add_option("--width", arguments->options.width, "Width of a frame, pixels")->check(CLI::Range(16, 8192));
  command->add_option("--height", arguments->options.height, "Height of a frame, pixels")->check(CLI::Range(16, 8192));
  command->add_flag("--video", arguments->video, "The project is of an H.264 video with a trajectory, not of pictures");
  command->add_option("--clock-offset", arguments->options.clockOffsetSecs, "Trajectory's clock minus the video's, seconds")
      ->check(finiteNumber());
  command->add_option("--readout", arguments->readoutMs, "Milliseconds that the camera takes to read its rows (rolling shutter)")
      ->check(numberWithin(-60.0, 60.0));
  command->add_flag("--gray", arguments->gray, "A grayscale camera");
}

}  // namespace alidade::cli
