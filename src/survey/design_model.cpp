// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/design_model.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace alidade {

Bounds DesignModel::bounds() const {
  Bounds box;
  for (const auto index : triangles) box.add(world(index));
  for (const auto& edge : edges)
    for (const auto index : edge) box.add(world(index));
  return box;
}

Bounds DesignModel::elementBounds(std::size_t element) const {
  const DesignElement& e = elements[element];
  Bounds box;
  for (std::uint32_t i = 0; i < e.indexCount; ++i) box.add(world(triangles[e.firstIndex + i]));
  for (std::uint32_t i = 0; i < e.edgeCount; ++i)
    for (const auto index : edges[e.firstEdge + i]) box.add(world(index));
  return box;
}

namespace {

/// One vertex index for all vertices in the same weld cell.
class Welder {
 public:
  Welder(const std::vector<glm::vec3>& vertices, double cell) : m_vertices(vertices), m_cell(cell) {}

  std::uint32_t canonical(std::uint32_t index) {
    const glm::vec3& v = m_vertices[index];
    const std::array<std::int64_t, 3> key{std::llround(v.x / m_cell), std::llround(v.y / m_cell),
                                          std::llround(v.z / m_cell)};
    return m_first.emplace(key, index).first->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const std::array<std::int64_t, 3>& k) const noexcept {
      std::uint64_t h = 0x9E3779B97F4A7C15ull;
      for (const auto v : k) h = (h ^ static_cast<std::uint64_t>(v)) * 0xBF58476D1CE4E5B9ull, h ^= h >> 29;
      return h;
    }
  };
  const std::vector<glm::vec3>& m_vertices;
  double m_cell;
  std::unordered_map<std::array<std::int64_t, 3>, std::uint32_t, Hash> m_first;
};

struct EdgeUse {
  glm::vec3 normal{0};
  int count = 0;
  bool crease = false;
};

}  // namespace

void findFeatureEdges(DesignModel& model, double creaseAngle, double weld) {
  model.edges.clear();
  const float cosine = static_cast<float>(std::cos(creaseAngle));
  for (DesignElement& element : model.elements) {
    element.firstEdge = static_cast<std::uint32_t>(model.edges.size());
    Welder welder(model.vertices, weld);
    std::unordered_map<std::uint64_t, EdgeUse> uses;
    for (std::uint32_t i = 0; i + 2 < element.indexCount; i += 3) {
      std::array<std::uint32_t, 3> corner;
      for (int c = 0; c < 3; ++c) corner[c] = welder.canonical(model.triangles[element.firstIndex + i + c]);
      const glm::vec3 cross = glm::cross(model.vertices[corner[1]] - model.vertices[corner[0]],
                                         model.vertices[corner[2]] - model.vertices[corner[0]]);
      const float length = glm::length(cross);
      if (!(length > 0)) continue;
      const glm::vec3 normal = cross / length;
      for (int c = 0; c < 3; ++c) {
        const auto [low, high] = std::minmax(corner[c], corner[(c + 1) % 3]);
        EdgeUse& use = uses[(static_cast<std::uint64_t>(low) << 32) | high];
        if (use.count == 0) use.normal = normal;
        else if (glm::dot(use.normal, normal) < cosine) use.crease = true;
        ++use.count;
      }
    }
    std::vector<std::uint64_t> keys;
    for (const auto& [key, use] : uses)
      if (use.count == 1 || use.crease) keys.push_back(key);
    std::sort(keys.begin(), keys.end());
    for (const auto key : keys)
      model.edges.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)});
    element.edgeCount = static_cast<std::uint32_t>(model.edges.size()) - element.firstEdge;
  }
}

}  // namespace alidade
