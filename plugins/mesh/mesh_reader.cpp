// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mesh/mesh_reader.h"

#include <filesystem>
#include <string_view>

#include "mesh/mesh_source.h"
#include "plugin_api/child_process.h"
#include "survey/design_stream.h"

namespace alidade {

namespace {

/// "element face 12" with a count above zero, in the part of the header that the probe holds.
bool plyHasFaces(const FileProbe& probe) {
  const std::string_view head(reinterpret_cast<const char*>(probe.head.data()), probe.head.size());
  const auto at = head.find("element face ");
  if (at == head.npos) return false;
  const auto digit = head.find_first_not_of(" 0", at + 13);
  return digit != head.npos && head[digit] >= '1' && head[digit] <= '9';
}

}  // namespace

ReaderDescription MeshReader::description() const {
  return {"mesh", "Mesh (OBJ, glTF, STL, PLY)", {"obj", "gltf", "glb", "stl", "ply"}};
}

int MeshReader::sniff(const FileProbe& probe) const {
  if (probe.isFolder) return 0;
  if (probe.startsWith("glTF")) return 90;
  if (probe.startsWith("ply\n") || probe.startsWith("ply\r")) return plyHasFaces(probe) ? 70 : 0;
  if (probe.extension == "gltf") return probe.holds("\"asset\"") ? 60 : 45;
  if (probe.extension == "obj" || probe.extension == "stl" || probe.extension == "glb") return 45;
  return 0;
}

Result<DesignInfo> MeshReader::inspect(const std::string& path) const {
  const auto source = prepareMesh(path);
  if (!source) return fail(source.error());
  DesignInfo info;
  info.elementCount = source->elementCount;
  info.schema = source->details.substr(0, source->details.find(','));
  info.details = source->details;
  return info;
}

Result<DesignModel> MeshReader::read(const std::string& path, const Progress& progress,
                                     std::vector<ImportWarning>& warnings) const {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) return fail("The file does not exist or is no plain file", path);
  ChildOptions options;
  options.helper = "alidade-mesh-convert";
  options.arguments = {path};
  options.inputName = path;
  options.purpose = "Reading " + std::filesystem::path(path).filename().string();
  scaleLimits(options, std::filesystem::file_size(path, code), 200, 30);
  const auto bytes = runChild(options, progress);
  if (!bytes) return fail(bytes.error());
  auto stream = decodeDesign(*bytes);
  if (!stream) return fail(stream.error().in(path));
  for (ConversionNote& note : stream->notes) warnings.push_back({std::move(note.what), std::move(note.where)});
  stream->model.name = std::filesystem::path(path).stem().string();
  return std::move(stream->model);
}

}  // namespace alidade
