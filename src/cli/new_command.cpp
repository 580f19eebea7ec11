// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <filesystem>

#include <fmt/format.h>

#include "app/jobs.h"
#include "cli/command.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

/// Work already done in a project, and any other file, is not lost to a slip of the keyboard.
Result<void> checkTarget(const std::string& path, bool overwrite) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  if (!loadProject(path)) return fail("The file exists and is no Alidade project: it is not overwritten", path, "Choose another name");
  if (!overwrite) return fail("The project exists already", path, "Choose another name, or give --overwrite to replace it");
  return {};
}

/// What the project holds now, for both verbs.
Answer describe(const Project& project, const std::string& path, const std::vector<std::string>& notes) {
  std::size_t posed = 0, withoutLens = 0;
  for (const Frame& frame : project.frames) {
    posed += frame.cameraFromWorld.has_value();
    withoutLens += !frame.camera;
  }
  Answer answer;
  answer.json = {{"project", path},
                 {"scans", project.scans.size()},
                 {"designs", project.designs.size()},
                 {"cameras", project.cameras.size()},
                 {"frames", project.frames.size()},
                 {"frames_with_pose", posed},
                 {"frames_without_camera", withoutLens},
                 {"stake_points", project.stakePoints.size()},
                 {"control_points", project.controlPoints.size()},
                 {"notes", notes}};
  const auto counted = [](std::size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); };
  answer.text = fmt::format("{}: {}, {}, {} ({} with a pose{}), {}\n", path, counted(project.scans.size(), "scan"),
                            counted(project.designs.size(), "design"), counted(project.frames.size(), "frame"), posed,
                            withoutLens == 0 ? std::string() : fmt::format(", {} without a lens", withoutLens),
                            counted(project.stakePoints.size(), "stake-out point"));
  for (const std::string& note : notes) answer.text += "  note: " + note + "\n";
  return answer;
}

}  // namespace

void addNew(Verbs& verbs) {
  struct Arguments {
    std::string project;
    bool overwrite = false;
    NewProjectInputs inputs;
    std::vector<std::string> files;
    std::string name;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add(
      "new", "Make a project of scans, designs, pictures and cameras",
      [arguments](const Progress& progress) -> Result<Answer> {
        if (auto free = checkTarget(arguments->project, arguments->overwrite); !free) return fail(free.error());
        auto made = newProject(arguments->inputs, progress);
        if (!made) return fail(made.error());
        if (!arguments->files.empty()) {
          auto notes = std::move(made->notes);
          made = addToProject(made->project, arguments->files, progress);
          if (!made) return fail(made.error());
          made->notes.insert(made->notes.begin(), notes.begin(), notes.end());
        }
        Project& project = made->project;
        project.name = arguments->name.empty() ? std::filesystem::path(arguments->project).stem().string() : arguments->name;
        if (project.scans.empty() && project.designs.empty() && project.frames.empty())
          made->notes.push_back("The project holds no scan, no design and no picture. Give --scan, --design, --images or --video");
        if (auto saved = saveProject(project, arguments->project); !saved) return fail(saved.error());

        return describe(project, arguments->project, made->notes);
      });
  command->add_option("project", arguments->project, "Project file to write, *.alidade")->required();
  command->add_option("--scan", arguments->inputs.scans, "Point clouds; an E57 file's pictures and cameras come along");
  command->add_flag("--scan-alone", arguments->inputs.scansAlone, "Of --scan take the points, not the pictures and cameras");
  command->add_option("--design", arguments->inputs.designs, "IFC, OBJ, glTF, STL");
  command->add_option("--images", arguments->inputs.images, "Folders of pictures, or pictures");
  command->add_option("--video", arguments->inputs.videos, "Video files");
  command->add_option("--cameras", arguments->inputs.cameras, "COLMAP, Metashape, Bundler, transforms.json, XMP; calibrations, trajectories, tables");
  command->add_option("--rig", arguments->inputs.rigs, "Rig files: a sensor's trajectory and the cameras on it");
  command->add_option("--stake", arguments->inputs.stakePoints, "Stake-out points, CSV");
  command->add_option("--control", arguments->inputs.controlPoints, "Control points, CSV");
  command->add_option("--files", arguments->files, "Anything of the above, told apart by content");
  command->add_option("--name", arguments->name, "Name of the project");
  command->add_flag("--overwrite", arguments->overwrite, "Replace an existing project");
}

void addAdd(Verbs& verbs) {
  struct Arguments {
    std::string project;
    std::vector<std::string> files;
    bool dryRun = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add("add", "Add scans, designs, pictures, cameras or points to a project",
                                [arguments](const Progress& progress) -> Result<Answer> {
                                  auto project = loadProject(arguments->project);
                                  if (!project) return fail(project.error());
                                  auto made = addToProject(*project, arguments->files, progress);
                                  if (!made) return fail(made.error());
                                  if (!arguments->dryRun)
                                    if (auto saved = saveProject(made->project, arguments->project); !saved) return fail(saved.error());
                                  Answer answer = describe(made->project, arguments->project, made->notes);
                                  answer.json["saved"] = !arguments->dryRun;
                                  return answer;
                                });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("files", arguments->files, "Files and folders, told apart by content")->required();
  command->add_flag("--dry-run", arguments->dryRun, "Report only; leave the project as it is");
}

}  // namespace alidade::cli
