// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/jobs.h"
#include "app/shown_elements.h"
#include "cli/command.h"
#include "cli/display_options.h"
#include "cli/project_input.h"
#include "cloud/frame_pacer.h"
#include "io/video_writer.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string project, frame, output, size, range, storey;
  std::vector<std::string> hide;
  std::optional<double> time;
  std::uint64_t pointBudget = 0;
  double frameTimeMs = 0;
  bool bare = false, before = false;
};

Result<std::pair<int, int>> parseSize(const std::string& size) {
  if (size.empty()) return std::pair{0, 0};
  int width = 0, height = 0;
  char tail = 0;
  if (std::sscanf(size.c_str(), "%dx%d%c", &width, &height, &tail) != 2 || width < 16 || height < 16 || width > 16384 ||
      height > 16384)
    return fail("The size '" + size + "' is not WIDTHxHEIGHT", "--size", "Give pixels from 16 to 16384, such as 1920x1080");
  return std::pair{width, height};
}

/// The frame whose time is nearest; error where that is more than a frame's step away.
Result<std::size_t> frameAtTime(const Project& project, double secs) {
  const auto& frames = project.frames;
  if (frames.empty()) return fail("The project has no frames", project.path, "Add a video or pictures");
  std::size_t best = 0;
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (std::abs(frames[i].timeSecs - secs) < std::abs(frames[best].timeSecs - secs)) best = i;
  const double step = frames.size() > 1 ? (frames.back().timeSecs - frames.front().timeSecs) / static_cast<double>(frames.size() - 1) : 0;
  if (std::abs(frames[best].timeSecs - secs) > std::max(step, 1e-6))
    return fail(fmt::format("No frame is of {} s: they are of {:.3f} to {:.3f} s", secs, frames.front().timeSecs, frames.back().timeSecs),
                "--time", "Give a time in between");
  return best;
}

/// "10:20" or "10:20:2": first and last index, step.
struct FrameRange {
  std::size_t first = 0, last = 0, step = 1;
};
Result<FrameRange> parseRange(const std::string& text) {
  FrameRange range;
  char tail = 0;
  const int read = std::sscanf(text.c_str(), "%zu:%zu:%zu%c", &range.first, &range.last, &range.step, &tail);
  if ((read != 2 && read != 3) || text.find('-') != std::string::npos || range.first > range.last || range.step == 0 ||
      (read == 2 && text.find(':') != text.rfind(':')))
    return fail("The range '" + text + "' is not FIRST:LAST[:STEP]", "--frames", "Give indices from 0, such as 10:20 or 0:90:5");
  return range;
}

/// Refuses before the work what would be in vain after it, and what would cost the user a file: a
/// picture is never written over the project or one of its sources.
Result<void> checkOutput(const std::string& output, const Project& project, bool ofRange) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::string extension = fs::path(output).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (fs::is_directory(output, error) && !(ofRange && extension.empty())) return fail("This is a folder, not a file", output, "Give a file name");
  if (ofRange && extension != ".mp4" && !extension.empty())
    return fail(fmt::format("A range of frames is written as MP4, or as PNG into a folder, not as '{}'", extension), output,
                "Give a name that ends in .mp4, or one without an ending");
  if (!ofRange && extension != ".png" && !extension.empty())
    return fail(fmt::format("Pictures are written as PNG, not as '{}'", extension), output, "Give a name that ends in .png");
  const fs::path folder = fs::absolute(output, error).parent_path();
  if (!fs::is_directory(folder, error))
    return fail("The folder does not exist", output, "Make the folder first or choose another");
  bool taken = fs::equivalent(output, project.path, error);
  const auto check = [&](const SourceFile& source) {
    taken = taken || (!source.path.empty() && fs::equivalent(output, source.path, error));
  };
  for (const Scan& scan : project.scans) check(scan.source);
  for (const Design& design : project.designs) check(design.source);
  for (const Video& video : project.videos) check(video.source);
  for (const Frame& frame : project.frames) check(frame.image);
  if (taken) return fail("The project needs this file: it is not overwritten", output, "Choose another name");
  return {};
}

Result<std::uint64_t> parseBudget(const std::string& text) {
  std::uint64_t points = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), points);
  if (error != std::errc() || end != text.data() + text.size() || points == 0)
    return fail("'" + text + "' is no number of points", "--point-budget", "Give a whole number from 1");
  return points;
}

/// Only in memory: the project is not saved.
Result<void> applyVisibility(const Arguments& arguments, OpenProject& open) {
  bool found = arguments.storey.empty();
  std::set<std::string> storeys;
  for (Design& design : open.project.designs) {
    const auto loaded = open.data.designs.find(design.id);
    if (arguments.storey.empty() || loaded == open.data.designs.end()) continue;
    if (showOnlyStorey(design, *loaded->second, arguments.storey)) found = true;
    else design.visible = false;
    for (const DesignElement& element : loaded->second->elements)
      if (!element.storey.empty()) storeys.insert(element.storey);
  }
  if (!found)
    return fail(fmt::format("No element is of the storey '{}'", arguments.storey), "--storey",
                storeys.empty() ? "The designs have no storeys" : fmt::format("Give one of {}", fmt::join(storeys, ", ")));
  for (const std::string& name : arguments.hide)
    if (hideByName(open.project, open.data, name) == 0)
      return fail(fmt::format("No scan, design or element is called '{}'", name), "--hide", "alidade-cli overlay --json lists the elements in the picture");
  return {};
}

/// Before a refinement, for comparing: only in memory.
void takeImportedPoses(Project& project) {
  for (Frame& frame : project.frames) {
    if (!frame.originalCameraFromWorld) continue;
    frame.cameraFromWorld = frame.originalCameraFromWorld;
    frame.poseSource = PoseSource::File;
    frame.quality.reset();
  }
}

Json elementsJson(const RenderedFrame& rendered) {
  Json list = Json::array();
  for (const ElementPixels& pixels : rendered.picture.elements) {
    const DesignElement& element = rendered.description.designs[pixels.layer].model->elements[pixels.element];
    list.push_back({{"global_id", element.globalId}, {"name", element.name}, {"type", element.type},
                    {"storey", element.storey}, {"visible_px", pixels.visible}, {"hidden_px", pixels.hidden},
                    {"unknown_px", pixels.unknown}});
  }
  return list;
}

/// Draws a range of frames into an MP4, or into a folder of PNG files where the name has no ending. A frame without a
/// pose is left out of the folder and shown as it is in the video, and told of.
Result<Answer> runRange(const Arguments& arguments, const OpenProject& open, FrameWish wish, OverlayRenderer& renderer, PictureCache& pictures, const Progress& progress) {
  namespace fs = std::filesystem;
  const auto range = parseRange(arguments.range);
  if (!range) return fail(range.error());
  const auto& frames = open.project.frames;
  if (range->last >= frames.size())
    return fail(fmt::format("The project has frames 0 to {}", frames.size() - 1), "--frames", "End the range there");
  const bool folder = fs::path(arguments.output).extension().empty();
  std::error_code code;
  if (folder && !fs::create_directory(arguments.output, code) && code)
    return fail("The folder cannot be made: " + code.message(), arguments.output, "Choose another name");
  std::optional<VideoWriter> writer;
  FramePacer pacer;
  const FramePace pace{arguments.frameTimeMs, arguments.pointBudget};
  std::size_t written = 0;
  Json skipped = Json::array();
  for (std::size_t i = range->first; i <= range->last; i += range->step) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(static_cast<double>(i - range->first) / static_cast<double>(range->last - range->first + 1), "Drawing");
    if (i + range->step <= range->last) pictures.expect(open.project, {frames[i].id, frames[i + range->step].id});
    wish.pointBudget = pacer.begin(pace);
    auto rendered = renderFrame(open.project, open.data, frames[i].id, wish, renderer, pictures);
    if (rendered) pacer.end(std::max(rendered->picture.pointsJudged, rendered->picture.pointsDrawn));
    if (!rendered && frames[i].cameraFromWorld) return fail(rendered.error());
    if (!rendered) skipped.push_back(frames[i].name);
    if (!rendered && folder) continue;
    if (folder) {
      const std::string path = (fs::path(arguments.output) / fmt::format("frame_{:06}.png", i)).string();
      if (auto saved = exportPicture(*rendered, path, arguments.bare); !saved) return fail(saved.error());
    } else {
      const auto raw = rendered ? Result<std::shared_ptr<const ColourImage>>() : pictures.picture(open.project, frames[i]);
      if (!raw) return fail(raw.error());
      const ColourImage& colour = rendered ? rendered->picture.colour : **raw;
      if (!writer) {
        const double step = frames.size() > 1 ? (frames.back().timeSecs - frames.front().timeSecs) / static_cast<double>(frames.size() - 1) : 0;
        const double rate = step > 0 ? std::clamp(1 / (step * static_cast<double>(range->step)), 0.5, 240.0) : 15;
        auto made = VideoWriter::create(arguments.output, colour.width(), colour.height(), rate);
        if (!made) return fail(made.error());
        writer.emplace(std::move(*made));
      }
      if (auto saved = writer->write(colour); !saved) return fail(saved.error());
    }
    ++written;
  }
  if (writer)
    if (auto finished = writer->finish(); !finished) return fail(finished.error());
  if (written == 0) return fail("No frame of the range has a pose", "--frames", "Add poses: a COLMAP model or a trajectory that covers them");
  Answer answer;
  answer.json = {{"frames", written}, {"without_pose", skipped}, {"output", arguments.output}};
  answer.text = fmt::format("{}: {} frames", arguments.output, written);
  if (!skipped.empty()) answer.text += fmt::format("; {} without a pose {}", skipped.size(), folder ? "left out" : "shown as they are");
  answer.text += "\n";
  return answer;
}

Result<Answer> run(const Arguments& arguments, const DisplayOptions& display, const Progress& progress) {
  const auto check = [&](const Project& project) { return checkOutput(arguments.output, project, !arguments.range.empty()); };
  const std::string frame = arguments.frame.empty() ? "0" : arguments.frame;
  auto open = openProject(arguments.project, frame, true, progress.part(0.0, arguments.range.empty() ? 0.8 : 0.3), check);
  if (!open) return fail(open.error());
  if (arguments.time) {
    const auto at = frameAtTime(open->project, *arguments.time);
    if (!at) return fail(at.error());
    open->frame = open->project.frames[*at].id;
  }
  if (auto done = display.apply(open->project.display); !done) return fail(done.error());
  if (auto done = applyVisibility(arguments, *open); !done) return fail(done.error());
  if (arguments.before) takeImportedPoses(open->project);
  const auto size = parseSize(arguments.size);
  if (!size) return fail(size.error());

  auto renderer = OverlayRenderer::create();
  if (!renderer) return fail(renderer.error());
  PictureCache pictures;
  const FrameWish wish{size->first, size->second, arguments.pointBudget};
  if (!arguments.range.empty()) return runRange(arguments, *open, wish, **renderer, pictures, progress.part(0.3, 1));
  progress.report(0.8, "Drawing");
  auto rendered = renderFrame(open->project, open->data, open->frame, wish, **renderer, pictures);
  if (!rendered) return fail(rendered.error());
  if (auto saved = exportPicture(*rendered, arguments.output, arguments.bare); !saved) return fail(saved.error());

  const OverlayPicture& picture = rendered->picture;
  Answer answer;
  answer.json = {{"frame", open->project.findFrame(open->frame)->name},
                 {"width", picture.colour.width()},
                 {"height", picture.colour.height()},
                 {"points_total", picture.pointsTotal},
                 {"points_drawn", picture.pointsDrawn},
                 {"worst_error_px", picture.worstErrorPx},
                 {"elements", elementsJson(*rendered)},
                 {"device", (*renderer)->deviceName()},
                 {"output", arguments.output}};
  answer.text = fmt::format("{}: frame {}, {} × {} px, {} of {} points, worst drawn error {:.3f} px, {}\n", arguments.output,
                            answer.json["frame"].get<std::string>(), picture.colour.width(), picture.colour.height(),
                            picture.pointsDrawn, picture.pointsTotal, picture.worstErrorPx, rendered->title.hidden);
  return answer;
}

}  // namespace

void addOverlay(Verbs& verbs) {
  auto arguments = std::make_shared<Arguments>();
  auto display = std::make_shared<std::optional<DisplayOptions>>();
  CLI::App* command =
      verbs.add("overlay", "Draw the design over a frame and save the picture",
                [arguments, display](const Progress& progress) { return run(*arguments, **display, progress); });
  command->add_option("project", arguments->project, "Project file")->required();
  auto* which = command->add_option_group("which frame");
  which->add_option("--frame", arguments->frame, "Name, or index from 0");
  which->add_option("--time", arguments->time, "Seconds: the frame nearest to it")->check(finiteNumber());
  auto* range = which->add_option("--frames", arguments->range, "FIRST:LAST[:STEP], indices from 0: a video (.mp4), or a folder of pictures")
      ->check(checkedBy(parseRange, "RANGE"));
  which->require_option(1);
  command->add_option("-o,--output", arguments->output, "PNG to write; MP4 or folder with --frames")->required();
  command->add_option("--size", arguments->size, "WIDTHxHEIGHT; the raw picture's where not given")
      ->check(checkedBy(parseSize, "SIZE"));
  command->add_flag("--bare", arguments->bare, "Without the title block");
  command->add_flag("--before", arguments->before, "With the poses as they were imported, where a refinement replaced them");
  command->add_option("--storey", arguments->storey, "Of the design only this storey's elements");
  command->add_option("--hide", arguments->hide, "A scan, design or element that is left out, again for more: name, or an element's global id")->allow_extra_args(false);
  command->add_option("--point-budget", arguments->pointBudget, "At most so many points in view: of those that are shown, and of those that judge what is hidden")->check(checkedBy(parseBudget, "POINTS"));
  command->add_option("--frame-time", arguments->frameTimeMs, "With --frames: draw with as many points as keep a frame to so many milliseconds")
      ->check(numberWithin(1.0, 10'000.0))->needs(range);
  display->emplace(*command);
}

}  // namespace alidade::cli
