// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "mesh/mesh_source.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace alidade {

namespace {

constexpr std::uint64_t kLargestFile = std::uint64_t{2} << 30;

std::string ending(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  if (!text.empty()) text.erase(0, 1);
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Result<std::string> readAll(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    return fail("The file does not exist or is no plain file", path);
  const std::uint64_t size = std::filesystem::file_size(path, code);
  if (code) return fail("The file cannot be read: " + code.message(), path);
  if (size == 0) return fail("The file is empty", path, "Copy or export it again");
  if (size > kLargestFile) return fail("The file is larger than 2 GiB", path, "Split the model");
  std::string content(size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(content.data(), static_cast<std::streamsize>(size)))
    return fail("The file cannot be read", path, "Check the permission to read it");
  return content;
}

}  // namespace

MeshFormat meshFormat(const std::string& path, const std::string& content) {
  if (content.starts_with("glTF")) return MeshFormat::Glb;
  if (content.starts_with("ply\n") || content.starts_with("ply\r")) return MeshFormat::Ply;
  const std::string end = ending(path);
  if (end == "obj") return MeshFormat::Obj;
  if (end == "stl") return MeshFormat::Stl;
  if (end == "gltf") return MeshFormat::Gltf;
  if (end == "glb") return MeshFormat::Glb;
  return MeshFormat::Unknown;
}

glm::dvec3 wholeMetreOffset(const glm::dvec3& least, const glm::dvec3& most) {
  // A float near 128 m steps by 8 µm.
  const glm::dvec3 reach = glm::max(glm::abs(least), glm::abs(most));
  if (!(std::max({reach.x, reach.y, reach.z}) > 128)) return glm::dvec3(0);
  return glm::round(0.5 * (least + most));
}

Result<MeshSource> prepareMesh(const std::string& path) {
  auto content = readAll(path);
  if (!content) return fail(content.error());
  Result<MeshSource> source;
  switch (meshFormat(path, *content)) {
    case MeshFormat::Obj:
      source = prepareObj(*content, std::filesystem::path(path).parent_path().string());
      break;
    case MeshFormat::Stl: source = prepareStl(std::move(*content)); break;
    case MeshFormat::Ply: source = preparePly(std::move(*content)); break;
    case MeshFormat::Gltf: source = prepareGltf(*content, false); break;
    case MeshFormat::Glb: source = prepareGltf(*content, true); break;
    case MeshFormat::Unknown:
      return fail("The file is no mesh that is read", path, "Export it as OBJ, glTF, STL or PLY");
  }
  if (!source) return fail(source.error().in(path));
  return source;
}

}  // namespace alidade
