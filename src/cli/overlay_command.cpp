// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"
#include "cli/point_style_options.h"
#include "cli/project_input.h"
#include "io/video_writer.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

const std::map<std::string, LevelThreshold> kThresholds = {
    {"node", LevelThreshold::ByDistance}, {"point", LevelThreshold::ByPoint}, {"uniform", LevelThreshold::Uniform}};

struct Arguments {
  std::string project, frame, output, passes, hidden, size, range, threshold;
  std::optional<double> density, pointSize, time;
  bool bare = false;
};

Result<void> applyPasses(const std::string& list, DisplaySettings& display) {
  display.imagePass = display.depthPass = display.designPass = display.pointPass = false;
  std::size_t start = 0;
  while (start <= list.size()) {
    const auto comma = std::min(list.find(',', start), list.size());
    const std::string pass = list.substr(start, comma - start);
    if (pass == "image") display.imagePass = true;
    else if (pass == "depth") display.depthPass = true;
    else if (pass == "design") display.designPass = true;
    else if (pass == "points") display.pointPass = true;
    else return fail("There is no pass '" + pass + "'", "--passes", "Passes are image, depth, design and points");
    start = comma + 1;
  }
  return {};
}

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
Result<Answer> runRange(const Arguments& arguments, const OpenProject& open, const std::pair<int, int>& size,
                        OverlayRenderer& renderer, PictureCache& pictures, const Progress& progress) {
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
  std::size_t written = 0;
  Json skipped = Json::array();
  for (std::size_t i = range->first; i <= range->last; i += range->step) {
    if (progress.cancelled()) return fail(cancelledError());
    progress.report(static_cast<double>(i - range->first) / static_cast<double>(range->last - range->first + 1), "Drawing");
    if (i + range->step <= range->last) pictures.expect(open.project, {frames[i].id, frames[i + range->step].id});
    auto rendered = renderFrame(open.project, open.data, frames[i].id, size.first, size.second, renderer, pictures);
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

Result<Answer> run(const Arguments& arguments, const PointStyleOptions& style, const Progress& progress) {
  const auto check = [&](const Project& project) { return checkOutput(arguments.output, project, !arguments.range.empty()); };
  const std::string frame = arguments.frame.empty() ? "0" : arguments.frame;
  auto open = openProject(arguments.project, frame, true, progress.part(0.0, arguments.range.empty() ? 0.8 : 0.3), check);
  if (!open) return fail(open.error());
  if (arguments.time) {
    const auto at = frameAtTime(open->project, *arguments.time);
    if (!at) return fail(at.error());
    open->frame = open->project.frames[*at].id;
  }
  DisplaySettings& display = open->project.display;
  if (arguments.density) display.density = *arguments.density;
  if (!arguments.threshold.empty()) display.levelThreshold = kThresholds.at(arguments.threshold);
  if (arguments.pointSize) display.pointSize = *arguments.pointSize;
  if (!arguments.passes.empty())
    if (auto done = applyPasses(arguments.passes, display); !done) return fail(done.error());
  if (arguments.hidden == "hide") display.hidden = HiddenStyle::Hide;
  if (arguments.hidden == "ghost") display.hidden = HiddenStyle::Ghost;
  if (arguments.hidden == "dash") display.hidden = HiddenStyle::Dash;
  if (auto done = style.apply(display.points); !done) return fail(done.error());
  const auto size = parseSize(arguments.size);
  if (!size) return fail(size.error());

  auto renderer = OverlayRenderer::create();
  if (!renderer) return fail(renderer.error());
  PictureCache pictures;
  if (!arguments.range.empty()) return runRange(arguments, *open, *size, **renderer, pictures, progress.part(0.3, 1));
  progress.report(0.8, "Drawing");
  auto rendered =
      renderFrame(open->project, open->data, open->frame, size->first, size->second, **renderer, pictures);
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
  auto style = std::make_shared<std::optional<PointStyleOptions>>();
  CLI::App* command =
      verbs.add("overlay", "Draw the design over a frame and save the picture",
                [arguments, style](const Progress& progress) { return run(*arguments, **style, progress); });
  style->emplace(*command);
  command->add_option("project", arguments->project, "Project file")->required();
  auto* which = command->add_option_group("which frame");
  which->add_option("--frame", arguments->frame, "Name, or index from 0");
  which->add_option("--time", arguments->time, "Seconds: the frame nearest to it")->check(finiteNumber());
  which->add_option("--frames", arguments->range, "FIRST:LAST[:STEP], indices from 0: a video (.mp4), or a folder of pictures")
      ->check(checkedBy(parseRange, "RANGE"));
  which->require_option(1);
  command->add_option("-o,--output", arguments->output, "PNG to write; MP4 or folder with --frames")->required();
  command->add_option("--density", arguments->density, "Point density, 0 to 1")->check(numberWithin(0.0, 1.0));
  command->add_option("--threshold", arguments->threshold, "What is thinned by one distance: a node, a point, or all alike")
      ->check(CLI::IsMember({"node", "point", "uniform"}));
  command->add_option("--point-size", arguments->pointSize, "Factor on the automatic point size")->check(numberWithin(0.1, 20.0));
  command->add_option("--passes", arguments->passes, "Of image,depth,design,points")
      ->check(checkedBy([](const std::string& list) { DisplaySettings ignored; return applyPasses(list, ignored); }, "LIST"));
  command->add_option("--hidden", arguments->hidden, "Parts that the scan hides")->check(CLI::IsMember({"hide", "ghost", "dash"}));
  command->add_option("--size", arguments->size, "WIDTHxHEIGHT; the raw picture's where not given")
      ->check(checkedBy(parseSize, "SIZE"));
  command->add_flag("--bare", arguments->bare, "Without the title block");
}

}  // namespace alidade::cli
