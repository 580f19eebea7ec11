// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap/colmap_reader.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/input_file.h"
#include "colmap/colmap_model.h"
#include "plugin_api/text_file.h"

namespace alidade {

namespace fs = std::filesystem;

namespace {

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool isTextFile(const std::string& name) {
  return name == "cameras.txt" || name == "images.txt" || name == "points3D.txt";
}

bool isBinaryFile(const std::string& name) {
  return name == "cameras.bin" || name == "images.bin" || name == "points3D.bin";
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

Result<std::vector<std::byte>> bytesOf(const std::string& path) {
  const auto file = InputFile::open(path);
  if (!file) return fail(file.error());
  std::vector<std::byte> bytes(file->size());
  if (auto read = file->readAt(0, bytes); !read) return fail(read.error());
  return bytes;
}

/// Hands one file of the model to a parser, as text or as bytes.
template <class Parse>
Result<void> readPart(const std::string& path, const Parse& parse) {
  const auto bytes = bytesOf(path);
  return bytes ? parse(std::span<const std::byte>(*bytes)) : Result<void>(fail(bytes.error()));
}

std::string_view textOf(std::span<const std::byte> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

struct ReadModel {
  ColmapModel model;
  bool binary = false;
};

/// The text form where both are there and the path is of neither: people edit text.
Result<ReadModel> readModel(const std::string& path, bool withPoints, const Progress& progress) {
  const fs::path folder = folderOf(path);
  ReadModel read;
  read.binary = isBinaryFile(fs::path(path).filename().string()) || !isThere(folder / "cameras.txt");
  const std::string ending = read.binary ? ".bin" : ".txt";
  const std::string cameras = (folder / ("cameras" + ending)).string(), images = (folder / ("images" + ending)).string(),
                    points = (folder / ("points3D" + ending)).string();
  if (!isThere(cameras))
    return fail("The folder has no cameras.txt and no cameras.bin", folder.string(), "Choose the folder of a COLMAP model");
  ColmapModel& model = read.model;
  using Bytes = std::span<const std::byte>;
  const auto parsedCameras = readPart(cameras, [&](Bytes b) {
    return read.binary ? parseColmapBinaryCameras(b, cameras, model) : parseColmapCameras(textOf(b), cameras, model);
  });
  if (!parsedCameras) return fail(parsedCameras.error());
  if (!model.hasCameras()) return fail("The file describes no camera", cameras, "Export the model again");

  if (!isThere(images)) {
    model.warn("There is no images" + ending + ": cameras without poses were read", folder.string());
    return read;
  }
  const Progress first = progress.part(0, 0.5);
  const auto parsedImages = readPart(images, [&](Bytes b) {
    return read.binary ? parseColmapBinaryImages(b, images, withPoints, first, model)
                       : parseColmapImages(textOf(b), images, withPoints, first, model);
  });
  if (!parsedImages) return fail(parsedImages.error());

  if (!withPoints) return read;
  if (!isThere(points)) {
    model.warn("There is no points3D" + ending + ": no tie points were read", folder.string());
    return read;
  }
  const Progress second = progress.part(0.5, 1);
  const auto parsedPoints = readPart(points, [&](Bytes b) {
    return read.binary ? parseColmapBinaryPoints(b, points, second, model) : parseColmapPoints(textOf(b), points, second, model);
  });
  if (!parsedPoints) return fail(parsedPoints.error());
  return read;
}

Result<CameraSet> finished(Result<ReadModel> read, bool withPoints) {
  if (!read) return fail(read.error());
  CameraSet set = read->model.take();
  set.details = fmt::format("COLMAP {} model: {} cameras, {} images", read->binary ? "binary" : "text", set.cameras.size(),
                            set.pictures.size());
  if (withPoints) set.details += fmt::format(", {} points", set.tiePoints.size());
  return set;
}

}  // namespace

ReaderDescription ColmapReader::description() const { return {"colmap", "COLMAP model", {"txt", "bin"}}; }

int ColmapReader::sniff(const FileProbe& probe) const {
  const fs::path path(probe.path);
  if (probe.isFolder) {
    const bool cameras = isThere(path / "cameras.txt") || isThere(path / "cameras.bin");
    const bool images = isThere(path / "images.txt") || isThere(path / "images.bin");
    return cameras && images ? 90 : cameras ? 60 : 0;
  }
  const std::string name = path.filename().string();
  if (isBinaryFile(name)) return isThere(folderOf(probe.path) / "cameras.bin") ? 80 : 0;
  if (!isTextFile(name)) return 0;
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
