// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cctype>
#include <filesystem>

#include <fmt/format.h>

#include "cli/command.h"
#include "io/camera_export.h"
#include "io/project_store.h"

namespace alidade::cli {

namespace {

const char* formatName(CameraFormat format) {
  switch (format) {
    case CameraFormat::Colmap: return "colmap";
    case CameraFormat::Transforms: return "transforms";
    case CameraFormat::Table: return "csv";
  }
  return "";
}

/// A name with an ending of letters, of nothing that is there: hardly meant as a folder.
bool looksLikeFile(const std::string& path) {
  std::error_code error;
  const std::string ending = std::filesystem::path(path).extension().string();
  return ending.size() > 1 && std::isalpha(static_cast<unsigned char>(ending[1])) && !std::filesystem::is_directory(path, error);
}

/// Of a folder, the model in it counts.
bool isThere(const std::string& path, CameraFormat format) {
  std::error_code error;
  const std::filesystem::path target(path);
  return std::filesystem::exists(format == CameraFormat::Colmap ? target / "cameras.txt" : target, error);
}

}  // namespace

void addExportCameras(Verbs& verbs) {
  struct Arguments {
    std::string project, output;
    bool overwrite = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = verbs.add(
      "export-cameras", "Write cameras and poses for other programs: COLMAP, transforms.json, CSV",
      [arguments](const Progress&) -> Result<Answer> {
        const CameraFormat format = cameraFormatOf(arguments->output);
        if (format == CameraFormat::Colmap && looksLikeFile(arguments->output))
          return fail("Cameras are not written as '" + std::filesystem::path(arguments->output).extension().string() + "'", arguments->output,
                      "Name a file .json or .csv, or a folder (with a slash behind it where its name has a full stop) for COLMAP's text files");
        if (!arguments->overwrite && isThere(arguments->output, format))
          return fail("The target exists already", arguments->output, "Choose another name, or give --overwrite to replace it");
        const auto project = loadProject(arguments->project);
        if (!project) return fail(project.error());
        const auto done = exportCameras(*project, format, arguments->output);
        if (!done) return fail(done.error());
        Answer answer;
        answer.json = {{"output", arguments->output}, {"format", formatName(format)}, {"frames", done->frames},
                       {"cameras", done->cameras},    {"points", done->points},       {"notes", done->notes}};
        answer.text = fmt::format("{}: {} poses, {} cameras, {} points\n", arguments->output, done->frames, done->cameras, done->points);
        for (const std::string& note : done->notes) answer.text += "  note: " + note + "\n";
        return answer;
      });
  command->add_option("project", arguments->project, "Project file")->required();
  command->add_option("-o,--output", arguments->output, "FILE.json, FILE.csv, or a folder for COLMAP's text files")->required();
  command->add_flag("--overwrite", arguments->overwrite, "Replace what is there");
}

}  // namespace alidade::cli
