// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"
#include "cli/point_style_options.h"
#include "cli/project_input.h"

namespace alidade::cli {

namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string project, frame, output, passes, hidden, size;
  std::optional<double> density, pointSize;
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

/// Refuses before the work what would be in vain after it, and what would cost the user a file: a
/// picture is never written over the project or one of its sources.
Result<void> checkOutput(const std::string& output, const Project& project) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::string extension = fs::path(output).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (fs::is_directory(output, error)) return fail("This is a folder, not a file", output, "Give a file name");
  if (extension != ".png" && !extension.empty())
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

Result<Answer> run(const Arguments& arguments, const PointStyleOptions& style, const Progress& progress) {
  const auto check = [&](const Project& project) { return checkOutput(arguments.output, project); };
  auto open = openProject(arguments.project, arguments.frame, true, progress.part(0.0, 0.8), check);
  if (!open) return fail(open.error());
  DisplaySettings& display = open->project.display;
  if (arguments.density) display.density = *arguments.density;
  if (arguments.pointSize) display.pointSize = *arguments.pointSize;
  if (!arguments.passes.empty())
    if (auto done = applyPasses(arguments.passes, display); !done) return fail(done.error());
  if (arguments.hidden == "hide") display.hidden = HiddenStyle::Hide;
  if (arguments.hidden == "ghost") display.hidden = HiddenStyle::Ghost;
  if (arguments.hidden == "dash") display.hidden = HiddenStyle::Dash;
  if (auto done = style.apply(display.points); !done) return fail(done.error());
  const auto size = parseSize(arguments.size);
  if (!size) return fail(size.error());

  progress.report(0.8, "Drawing");
  auto renderer = OverlayRenderer::create();
  if (!renderer) return fail(renderer.error());
  PictureCache pictures;
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
  command->add_option("--frame", arguments->frame, "Name, or index from 0")->required();
  command->add_option("-o,--output", arguments->output, "PNG to write")->required();
  command->add_option("--density", arguments->density, "Point density, 0 to 1")->check(CLI::Range(0.0, 1.0));
  command->add_option("--point-size", arguments->pointSize, "Factor on the automatic point size")->check(CLI::Range(0.1, 20.0));
  command->add_option("--passes", arguments->passes, "Of image,depth,design,points")
      ->check(checkedBy([](const std::string& list) { DisplaySettings ignored; return applyPasses(list, ignored); }, "LIST"));
  command->add_option("--hidden", arguments->hidden, "Parts that the scan hides")->check(CLI::IsMember({"hide", "ghost", "dash"}));
  command->add_option("--size", arguments->size, "WIDTHxHEIGHT; the raw picture's where not given")
      ->check(checkedBy(parseSize, "SIZE"));
  command->add_flag("--bare", arguments->bare, "Without the title block");
}

}  // namespace alidade::cli
