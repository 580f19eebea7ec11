// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

// alidade-mesh-convert FILE
//
// Reads one mesh file with assimp and sends it to descriptor 3 as a design stream
// (plugin_api/child_process.h, survey/design_stream.h). Runs with limits on memory and time.

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>
#include <set>

#include <unistd.h>

#include <assimp/DefaultIOSystem.h>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/ProgressHandler.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "mesh/mesh_source.h"
#include "plugin_api/child_process.h"
#include "survey/design_builder.h"
#include "survey/design_stream.h"

namespace alidade {

namespace {

namespace fs = std::filesystem;

/// Gives assimp the prepared text under the file's name, and plain files beside it (materials, buffers).
class PreparedFile : public Assimp::DefaultIOSystem {
 public:
  PreparedFile(std::string name, const std::string& content) : m_name(std::move(name)), m_content(content) {}

  bool Exists(const char* file) const override { return file == m_name || plainFile(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (file == m_name)
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(m_content.data()), m_content.size(), false);
    if (!plainFile(file) || std::strpbrk(mode, "wa+")) return nullptr;
    return DefaultIOSystem::Open(file, mode);
  }

 private:
  /// No device, no pipe, nothing that takes for ever.
  static bool plainFile(const char* file) {
    std::error_code code;
    return fs::is_regular_file(file, code) && fs::file_size(file, code) < (std::uintmax_t{1} << 31);
  }
  std::string m_name;
  const std::string& m_content;
};

class Listener : public Assimp::ProgressHandler {
 public:
  explicit Listener(ChildReporter& reporter) : m_reporter(reporter) {}
  bool Update(float fraction) override {
    if (fraction >= 0) m_reporter.progress(0.1 + 0.7 * std::min(fraction, 1.0f), "Reading the design");
    return true;
  }

 private:
  ChildReporter& m_reporter;
};

std::uint8_t channel(float value, bool linear) {
  double v = std::clamp(std::isfinite(value) ? static_cast<double>(value) : 0.8, 0.0, 1.0);
  // IEC 61966-2-1: glTF's factors are linear, the screen's are not.
  if (linear) v = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * v));
}

constexpr Rgba8 kDefaultColour{200, 200, 200, 255};

Rgba8 colourOf(const aiMaterial& material, bool linear) {
  aiString name;
  if (material.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS && std::strcmp(name.C_Str(), AI_DEFAULT_MATERIAL_NAME) == 0)
    return kDefaultColour;
  aiColor4D colour(0.8f, 0.8f, 0.8f, 1);
  if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS &&
      material.Get(AI_MATKEY_COLOR_DIFFUSE, colour) != aiReturn_SUCCESS)
    return kDefaultColour;
  float opacity = colour.a;
  material.Get(AI_MATKEY_OPACITY, opacity);
  return {channel(colour.r, linear), channel(colour.g, linear), channel(colour.b, linear), channel(opacity, false)};
}

class SceneReader {
 public:
  SceneReader(const aiScene& scene, const MeshSource& source, DesignBuilder& builder)
      : m_scene(scene), m_source(source), m_builder(builder) {}

  void read() {
    if (m_scene.mRootNode) visit(*m_scene.mRootNode, glm::dmat4(1), {});
  }
  std::size_t skippedFaces() const { return m_skipped; }

 private:
  static glm::dmat4 matrixOf(const aiMatrix4x4& m) {
    glm::dmat4 out;
    for (unsigned row = 0; row < 4; ++row)
      for (unsigned column = 0; column < 4; ++column) out[static_cast<int>(column)][static_cast<int>(row)] = m[row][column];
    return out;
  }

  void visit(const aiNode& node, const glm::dmat4& parent, const std::string& above) {
    const glm::dmat4 global = parent * matrixOf(node.mTransformation);
    const std::string name = node.mName.C_Str();
    if (node.mNumMeshes > 0) addElement(node, global, above);
    for (unsigned i = 0; i < node.mNumChildren; ++i) visit(*node.mChildren[i], global, name);
  }

  glm::dvec3 world(const glm::dmat4& global, const aiVector3D& v) const {
    glm::dvec3 p = glm::dvec3(global * glm::dvec4(v.x, v.y, v.z, 1.0)) + m_source.offset;
    if (m_source.yUp) p = {p.x, -p.z, p.y};
    return p;
  }

  void addElement(const aiNode& node, const glm::dmat4& global, const std::string& above) {
    DesignElement element;
    element.name = node.mName.C_Str();
    element.storey = m_source.nodes.empty() ? std::string() : above;
    takeGltfName(element);
    if (element.name.empty() || element.name.starts_with("$$$"))
      element.name = node.mNumMeshes ? m_scene.mMeshes[node.mMeshes[0]]->mName.C_Str() : "";
    if (element.name.empty()) element.name = "mesh";
    // A name that is stable between reads: the file's own, numbered where it comes again.
    const int again = ++m_names[element.name];
    element.globalId = again == 1 ? element.name : fmt::format("{}#{}", element.name, again);
    m_builder.beginElement(std::move(element));
    const bool mirrored = glm::determinant(glm::dmat3(global)) < 0;
    std::map<std::uint32_t, double> areaOfColour;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) addMesh(*m_scene.mMeshes[node.mMeshes[i]], global, mirrored, areaOfColour);
    const auto most = std::max_element(areaOfColour.begin(), areaOfColour.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most != areaOfColour.end()) m_builder.setColour(std::bit_cast<Rgba8>(most->first));
    if (m_builder.triangleCount() == 0) m_builder.dropElement();
  }

  /// "n12" of the flattened file back to what node 12 is called.
  void takeGltfName(DesignElement& element) const {
    if (m_source.nodes.empty()) return;
    const std::string text = element.name;
    std::size_t index = m_source.nodes.size();
    if (text.size() > 1 && text[0] == 'n') index = std::strtoul(text.c_str() + 1, nullptr, 10);
    if (index >= m_source.nodes.size()) return;
    element.name = m_source.nodes[index].name.empty() ? fmt::format("node {}", index) : m_source.nodes[index].name;
    element.storey = m_source.nodes[index].parent;
  }

  void addMesh(const aiMesh& mesh, const glm::dmat4& global, bool mirrored, std::map<std::uint32_t, double>& areaOfColour) {
    double area = 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) {
        ++m_skipped;
        continue;
      }
      glm::dvec3 corner[3];
      for (int c = 0; c < 3; ++c) {
        if (face.mIndices[c] >= mesh.mNumVertices) return;
        corner[c] = world(global, mesh.mVertices[face.mIndices[c]]);
      }
      if (mirrored) std::swap(corner[1], corner[2]);
      m_builder.addTriangle(corner[0], corner[1], corner[2]);
      area += glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
    }
    const Rgba8 colour = mesh.mMaterialIndex < m_scene.mNumMaterials
                             ? colourOf(*m_scene.mMaterials[mesh.mMaterialIndex], m_source.linearColours)
                             : kDefaultColour;
    areaOfColour[std::bit_cast<std::uint32_t>(colour)] += area;
  }

  const aiScene& m_scene;
  const MeshSource& m_source;
  DesignBuilder& m_builder;
  std::map<std::string, int> m_names;
  std::size_t m_skipped = 0;
};

Result<DesignStream> convert(const std::string& path, ChildReporter& reporter) {
  reporter.progress(0, "Reading the design");
  auto source = prepareMesh(path);
  if (!source) return fail(source.error());

  const std::string name = (fs::path(path).parent_path() / ("prepared." + source->ending)).string();
  Assimp::Importer importer;
  importer.SetIOHandler(new PreparedFile(name, source->content));
  importer.SetProgressHandler(new Listener(reporter));
  // Lines and points are no surfaces.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(name, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_ValidateDataStructure);
  if (!scene)
    return fail(fmt::format("The file could not be converted: {}", importer.GetErrorString()), path,
                "Export it again from the design program");

  DesignBuilder builder;
  SceneReader reader(*scene, *source, builder);
  reader.read();
  DesignBuilder::Summary summary;
  auto model = builder.finish(summary);
  if (!model) return fail(model.error().in(path));
  DesignStream stream{std::move(*model), std::move(source->notes)};
  const auto note = [&](std::size_t count, const char* what) {
    if (count) stream.notes.push_back({fmt::format("{} {}", count, what), {}});
  };
  note(reader.skippedFaces(), "lines and points are not drawn");
  note(summary.degenerate, "triangles without area were left out");
  note(summary.notFinite, "triangles lie beyond all bounds and were left out");
  note(summary.emptyElements, "groups had surfaces without area and were left out");
  return stream;
}

int run(const std::string& path) {
  ChildReporter reporter;
  try {
    auto stream = convert(path, reporter);
    if (!stream) return reporter.fail(stream.error());
    return reporter.done(encodeDesign(*stream));
  } catch (const std::bad_alloc&) {
    return reporter.fail({"The converter needed more memory than it may take for this file", path,
                          "Split the model, or export it with fewer details"});
  } catch (const std::exception& e) {
    return reporter.fail({fmt::format("The file could not be converted: {}", e.what()), path, "Export it again"});
  }
}

}  // namespace

}  // namespace alidade

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  ::_exit(alidade::run(argv[1]));
}
