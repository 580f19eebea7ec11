// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <glm/gtc/quaternion.hpp>

#include "mesh/mesh_source.h"

namespace alidade {

namespace {

using Json = nlohmann::json;
constexpr const char* kExportAgain = "Export it again as glTF 2.0 without compression";

/// GLB: 12 bytes of header, then chunks of length, type, data (glTF 2.0, "GLB File Format Specification").
struct Container {
  std::string json;
  std::string rest;  ///< the chunks behind the JSON one, as they are
};

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

Result<Container> openGlb(const std::string& bytes) {
  if (bytes.size() < 20 || !bytes.starts_with("glTF"))
    return fail("The file is no GLB file or is cut off in its header", {}, kExportAgain);
  if (word(bytes, 4) != 2)
    return fail(fmt::format("The file is glTF version {}; version 2 is read", word(bytes, 4)), {}, kExportAgain);
  const std::uint64_t length = word(bytes, 12);
  if (std::memcmp(bytes.data() + 16, "JSON", 4) != 0 || 20 + length > bytes.size() || word(bytes, 8) > bytes.size())
    return fail("The GLB file is cut off", {}, "Copy or export it again");
  return Container{bytes.substr(20, length), bytes.substr(20 + length)};
}

std::string closeGlb(std::string json, const std::string& rest) {
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string out = "glTF";
  const auto put = [&out](std::size_t value) {
    for (int i = 0; i < 4; ++i) out += static_cast<char>(value >> (8 * i));
  };
  put(2);
  put(20 + json.size() + rest.size());
  put(json.size());
  return out + "JSON" + json + rest;
}

std::optional<double> numberAt(const Json& array, std::size_t i) {
  if (!array.is_array() || i >= array.size() || !array[i].is_number()) return std::nullopt;
  const double value = array[i].get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

bool fill(const Json& node, const char* key, double* to, std::size_t count) {
  if (!node.contains(key)) return true;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = numberAt(node[key], i);
    if (!value) return false;
    to[i] = *value;
  }
  return true;
}

/// A node's own transform: its matrix, or translation * rotation * scale (glTF 2.0, 3.5.3).
std::optional<glm::dmat4> localTransform(const Json& node) {
  glm::dmat4 matrix(1.0);
  if (node.contains("matrix")) {
    double values[16];
    if (!fill(node, "matrix", values, 16)) return std::nullopt;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = values[i];
    return matrix;
  }
  double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
  if (!fill(node, "translation", t, 3) || !fill(node, "rotation", q, 4) || !fill(node, "scale", s, 3))
    return std::nullopt;
  matrix = glm::mat4_cast(glm::normalize(glm::dquat(q[3], q[0], q[1], q[2])));
  for (int c = 0; c < 3; ++c) matrix[c] *= s[c];
  matrix[3] = glm::dvec4(t[0], t[1], t[2], 1.0);
  return matrix;
}

const Json& arrayOf(const Json& object, const char* key) {
  static const Json kNone = Json::array();
  const auto found = object.find(key);
  return found != object.end() && found->is_array() ? *found : kNone;
}

std::size_t indexOf(const Json& value) {
  return value.is_number_unsigned() ? value.get<std::size_t>() : std::numeric_limits<std::size_t>::max();
}

struct Placed {
  std::size_t node;
  glm::dmat4 globalFromNode;
  std::string parent;
};

/// Walks the scene with a stack of its own; a node met twice is an error, because a glTF scene is a forest.
Result<std::vector<Placed>> placeNodes(const Json& gltf) {
  const Json& nodes = arrayOf(gltf, "nodes");
  const std::size_t meshes = arrayOf(gltf, "meshes").size();
  struct Visit {
    std::size_t node;
    glm::dmat4 globalFromParent;
    std::string parent;
  };
  std::vector<Visit> open;
  const Json& scenes = arrayOf(gltf, "scenes");
  if (!scenes.empty()) {
    const std::size_t scene = gltf.contains("scene") ? indexOf(gltf["scene"]) : 0;
    if (scene >= scenes.size()) return fail("The file's scene does not exist", {}, kExportAgain);
    for (const Json& root : arrayOf(scenes[scene], "nodes")) open.push_back({indexOf(root), glm::dmat4(1), {}});
  } else {
    std::vector<bool> isChild(nodes.size(), false);
    for (const Json& node : nodes)
      for (const Json& child : arrayOf(node, "children"))
        if (indexOf(child) < isChild.size()) isChild[indexOf(child)] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (!isChild[i]) open.push_back({i, glm::dmat4(1), {}});
  }
  std::vector<bool> seen(nodes.size(), false);
  std::vector<Placed> placed;
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const std::string where = fmt::format("node {}", visit.node);
    if (visit.node >= nodes.size()) return fail("The file names a node that does not exist", where, kExportAgain);
    if (seen[visit.node]) return fail("A node stands below itself or below two others", where, kExportAgain);
    seen[visit.node] = true;
    const Json& node = nodes[visit.node];
    const auto local = localTransform(node);
    if (!local) return fail("A node's transform holds something that is no number", where, kExportAgain);
    const glm::dmat4 global = visit.globalFromParent * *local;
    const std::string name = node.value("name", std::string());
    if (node.contains("mesh")) {
      if (indexOf(node["mesh"]) >= meshes)
        return fail("A node names a mesh that does not exist", where, kExportAgain);
      placed.push_back({visit.node, global, visit.parent});
    }
    for (const Json& child : arrayOf(node, "children"))
      open.push_back({indexOf(child), global, name.empty() ? visit.parent : name});
  }
  return placed;
}

Result<void> checkFeatures(const Json& gltf) {
  if (!gltf.is_object()) return fail("The file holds no glTF object", {}, kExportAgain);
  const std::string version = gltf.value("asset", Json::object()).value("version", std::string("unknown"));
  if (!version.starts_with("2."))
    return fail(fmt::format("The file is glTF version {}; version 2 is read", version), {}, kExportAgain);
  for (const Json& extension : arrayOf(gltf, "extensionsRequired")) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : std::string("without a name");
    if (name.find("draco") != name.npos || name.find("meshopt") != name.npos || name.find("quantization") != name.npos)
      return fail(fmt::format("The file needs the extension {}, which is not read", name), {}, kExportAgain);
  }
  return {};
}

/// float32 steps of the positions themselves: a note where they are coarser than half a millimetre.
void noteCoarsePositions(const Json& gltf, std::vector<ConversionNote>& notes) {
  double reach = 0;
  for (const Json& accessor : arrayOf(gltf, "accessors"))
    for (const char* key : {"min", "max"})
      if (accessor.value("type", std::string()) == "VEC3" && accessor.contains(key))
        for (std::size_t i = 0; i < 3; ++i) reach = std::max(reach, std::abs(numberAt(accessor[key], i).value_or(0)));
  const double step = reach * std::numeric_limits<float>::epsilon();
  if (step > 0.0005)
    notes.push_back({fmt::format("The positions are floats far from the origin, good to {:.0f} mm only: export with the "
                                 "offset in a node's translation", 1000 * step), {}});
}

Result<MeshSource> flatten(Json gltf) {
  if (auto checked = checkFeatures(gltf); !checked) return fail(checked.error());
  const auto placed = placeNodes(gltf);
  if (!placed) return fail(placed.error());
  if (placed->empty()) return fail("The file's scene holds no mesh", {}, "Export the design as surfaces");
  MeshSource source;
  source.yUp = source.linearColours = true;
  glm::dvec3 least(placed->front().globalFromNode[3]), most = least;
  for (const Placed& p : *placed) {
    least = glm::min(least, glm::dvec3(p.globalFromNode[3]));
    most = glm::max(most, glm::dvec3(p.globalFromNode[3]));
  }
  source.offset = wholeMetreOffset(least, most);
  source.nodes.resize(gltf["nodes"].size());
  Json nodes = Json::array(), roots = Json::array();
  for (const Placed& p : *placed) {
    const Json& old = gltf["nodes"][p.node];
    source.nodes[p.node] = {old.value("name", std::string()), p.parent};
    Json matrix = Json::array();
    for (int i = 0; i < 16; ++i)
      matrix.push_back(p.globalFromNode[i / 4][i % 4] - (i >= 12 && i < 15 ? source.offset[i - 12] : 0.0));
    roots.push_back(nodes.size());
    nodes.push_back({{"name", fmt::format("n{}", p.node)}, {"mesh", old["mesh"]}, {"matrix", std::move(matrix)}});
  }
  noteCoarsePositions(gltf, source.notes);
  gltf["nodes"] = std::move(nodes);
  gltf["scenes"] = Json::array({{{"nodes", std::move(roots)}}});
  gltf["scene"] = 0;
  // Pictures are not drawn, and what is not read cannot fail.
  for (const char* part : {"skins", "animations", "cameras", "images", "textures", "samplers"}) gltf.erase(part);
  if (gltf.contains("materials"))
    for (Json& material : gltf["materials"]) {
      const Json pbr = material.value("pbrMetallicRoughness", Json::object());
      Json kept = {{"name", material.value("name", std::string())}};
      if (pbr.contains("baseColorFactor")) kept["pbrMetallicRoughness"]["baseColorFactor"] = pbr["baseColorFactor"];
      material = std::move(kept);
    }
  source.elementCount = placed->size();
  source.details = fmt::format("glTF 2.0, {} nodes with a mesh", placed->size());
  source.content = gltf.dump();
  return source;
}

/// The JSON library writes by recursion: a file of brackets must not get that far.
bool nestsTooDeep(const std::string& json) {
  int depth = 0;
  bool inString = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (inString) {
      if (c == '\\') ++i;
      else if (c == '"') inString = false;
    } else if (c == '"') inString = true;
    else if (c == '[' || c == '{') {
      if (++depth > 200) return true;
    } else if (c == ']' || c == '}') --depth;
  }
  return false;
}

}  // namespace

Result<MeshSource> prepareGltf(const std::string& content, bool binary) {
  try {
    Container container{binary ? std::string() : content, {}};
    if (binary) {
      auto opened = openGlb(content);
      if (!opened) return fail(opened.error());
      container = std::move(*opened);
    }
    if (nestsTooDeep(container.json)) return fail("The file's JSON is nested too deep", {}, kExportAgain);
    auto source = flatten(Json::parse(container.json));
    if (!source) return fail(source.error());
    source->ending = binary ? "glb" : "gltf";
    if (binary) source->content = closeGlb(std::move(source->content), container.rest);
    return source;
  } catch (const Json::exception& e) {
    return fail(fmt::format("The file's JSON is broken: {}", e.what()), {}, "Copy or export it again");
  }
}

}  // namespace alidade
