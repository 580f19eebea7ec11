// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/colmap_reader.h"

#include <filesystem>

#include "colmap/colmap_model.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool isModelFile(const std::string& name) {
  return name == "cameras.txt" || name == "images.txt" || name == "points3D.txt";
}

fs::path folderOf(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return path;
  const fs::path parent = fs::path(path).parent_path();
  return parent.empty() ? fs::path(".") : parent;
}

/// A camera line: a number, then a model's name in capitals.
bool looksLikeCameras(const FileProbe& probe) {
  LineReader lines({reinterpret_cast<const char*>(probe.head.data()), probe.head.size()});
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
    FieldReader fields(line);
    std::string_view model;
    const bool hasId = fields.integer().has_value();
    return hasId && fields.next(model) && model.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789") == std::string_view::npos &&
           model.front() >= 'A';
  }
  return false;
}

Result<ColmapModel> readModel(const std::string& path, bool withPoints, const Progress& progress) {
  const fs::path folder = folderOf(path);
  const std::string cameras = (folder / "cameras.txt").string(), images = (folder / "images.txt").string(),
                    points = (folder / "points3D.txt").string();
  if (!isThere(cameras)) {
    if (isThere(folder / "cameras.bin"))
      return fail("The COLMAP model is binary", folder.string(),
                  "Export it as text: colmap model_converter --input_path DIR --output_path DIR --output_type TXT");
    return fail("The folder has no cameras.txt", folder.string(), "Choose the folder of a COLMAP text model");
  }
  ColmapModel model;
  const auto cameraText = readTextFile(cameras);
  if (!cameraText) return fail(cameraText.error());
  if (auto parsed = parseColmapCameras(*cameraText, cameras, model); !parsed) return fail(parsed.error());
  if (model.set.cameras.empty()) return fail("The file describes no camera", cameras, "Export the model again as text");

  if (!isThere(images)) {
    model.set.warnings.push_back({"There is no images.txt: cameras without poses were read", folder.string()});
    return model;
  }
  const auto imageText = readTextFile(images);
  if (!imageText) return fail(imageText.error());
  if (auto parsed = parseColmapImages(*imageText, images, withPoints, progress.part(0, 0.5), model); !parsed)
    return fail(parsed.error());

  if (!withPoints) return model;
  if (!isThere(points)) {
    model.set.warnings.push_back({"There is no points3D.txt: no tie points were read", folder.string()});
    return model;
  }
  const auto pointText = readTextFile(points);
  if (!pointText) return fail(pointText.error());
  if (auto parsed = parseColmapPoints(*pointText, points, progress.part(0.5, 1), model); !parsed) return fail(parsed.error());
  return model;
}

Result<CameraSet> finished(Result<ColmapModel> model, bool withPoints) {
  if (!model) return fail(model.error());
  CameraSet& set = model->set;
  set.details = "COLMAP text model: " + std::to_string(set.cameras.size()) + " cameras, " +
                std::to_string(set.pictures.size()) + " images";
  if (withPoints) set.details += ", " + std::to_string(set.tiePoints.size()) + " points";
  return std::move(set);
}

}  // namespace

ReaderDescription ColmapReader::description() const { return {"colmap", "COLMAP text model", {"txt"}}; }

int ColmapReader::sniff(const FileProbe& probe) const {
  const fs::path path(probe.path);
  // A binary model is claimed, too, so that its error says how to export text.
  if (probe.isFolder) {
    const bool cameras = isThere(path / "cameras.txt") || isThere(path / "cameras.bin");
    const bool images = isThere(path / "images.txt") || isThere(path / "images.bin");
    return cameras && images ? 90 : cameras ? 60 : 0;
  }
  const std::string name = path.filename().string();
  if (name == "cameras.bin" || name == "images.bin" || name == "points3D.bin")
    return isThere(folderOf(probe.path) / "cameras.bin") ? 60 : 0;
  if (!isModelFile(name)) return 0;
  if (name == "cameras.txt") return looksLikeCameras(probe) ? 80 : 0;
  return isThere(folderOf(probe.path) / "cameras.txt") ? 80 : 0;
}

Result<CameraSet> ColmapReader::inspect(const std::string& path) const {
  return finished(readModel(path, false, Progress()), false);
}

Result<CameraSet> ColmapReader::read(const std::string& path, const Progress& progress) const {
  return finished(readModel(path, true, progress), true);
}

}  // namespace alidade
