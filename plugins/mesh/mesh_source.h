// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "survey/design_stream.h"

namespace alidade {

enum class MeshFormat { Unknown, Obj, Stl, Gltf, Glb, Ply };

/// By content where it tells, else by the name's ending.
MeshFormat meshFormat(const std::string& path, const std::string& content);

/// A mesh file made fit for a reader that keeps floats: the same file with its coordinates moved by
/// `-offset`, whole metres, so that the mesh lies near zero.
struct MeshSource {
  std::string content;
  std::string ending;              ///< "obj", "stl", "gltf", "glb", "ply": what assimp shall take it for
  glm::dvec3 offset{0.0};          ///< in the file's own axes
  bool yUp = false;                ///< glTF
  bool linearColours = false;      ///< glTF
  std::uint64_t elementCount = 0;  ///< groups, solids or nodes named
  std::string details;             ///< "OBJ, 12 groups, 340 faces"
  std::vector<ConversionNote> notes;

  /// glTF alone: node "n<i>" of the rewritten file is node i of the original, named so, under that parent.
  struct Node {
    std::string name, parent;
  };
  std::vector<Node> nodes;
};

/// Checks the text (indices within range, finite coordinates, known statements) and moves it. `where` in
/// an error is the line.
Result<MeshSource> prepareObj(const std::string& content, const std::string& folder);
Result<MeshSource> prepareStl(std::string content);
Result<MeshSource> preparePly(std::string content);
/// glTF 2.0 as JSON or GLB. Nodes are flattened: each node with a mesh becomes a root with its global
/// transform, computed in double; skins and animations are left out.
Result<MeshSource> prepareGltf(const std::string& content, bool binary);

Result<MeshSource> prepareMesh(const std::string& path);

/// Rounded to whole metres where coordinates are far enough from zero for float to lose a hundredth of a
/// millimetre; else zero.
glm::dvec3 wholeMetreOffset(const glm::dvec3& least, const glm::dvec3& most);

}  // namespace alidade
