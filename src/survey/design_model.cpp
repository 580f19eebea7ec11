// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/design_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <utility>
#include <vector>

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

/// One vertex index for all vertices that lie within the weld distance of the first one seen.
class Welder {
 public:
  Welder(const std::vector<glm::vec3>& vertices, double weld)
      : m_vertices(vertices), m_weld(weld), m_cell(16 * weld) {}

  std::uint32_t canonical(std::uint32_t index) {
    const glm::dvec3 v(m_vertices[index]);
    // Near a cell's side the partner may lie in the next one; mostly the range is a single cell.
    const Key low = keyOf(v - m_weld), high = keyOf(v + m_weld);
    Key key;
    for (key[0] = low[0]; key[0] <= high[0]; ++key[0])
      for (key[1] = low[1]; key[1] <= high[1]; ++key[1])
        for (key[2] = low[2]; key[2] <= high[2]; ++key[2]) {
          const auto found = m_cells.find(key);
          if (found == m_cells.end()) continue;
          for (const std::uint32_t other : found->second)
            if (glm::distance(glm::dvec3(m_vertices[other]), v) <= m_weld) return other;
        }
    m_cells[keyOf(v)].push_back(index);
    return index;
  }

 private:
  using Key = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& k) const noexcept {
      std::uint64_t h = 0x9E3779B97F4A7C15ull;
      for (const auto v : k) h = (h ^ static_cast<std::uint64_t>(v)) * 0xBF58476D1CE4E5B9ull, h ^= h >> 29;
      return h;
    }
  };
  Key keyOf(const glm::dvec3& v) const {
    return {std::llround(std::floor(v.x / m_cell)), std::llround(std::floor(v.y / m_cell)),
            std::llround(std::floor(v.z / m_cell))};
  }

  const std::vector<glm::vec3>& m_vertices;
  double m_weld, m_cell;
  std::unordered_map<Key, std::vector<std::uint32_t>, Hash> m_cells;
};

/// How triangles meet at an edge. `normal` is the first one's, `upward` says whether it runs from the
/// edge's low index to its high one.
struct EdgeUse {
  glm::dvec3 normal{0};
  int count = 0;
  bool upward = false;
  bool crease = false;

  void add(const glm::dvec3& other, bool otherUpward, double cosine) {
    if (count++ == 0) {
      normal = other;
      upward = otherUpward;
      return;
    }
    // Neighbours that run along the edge the same way are wound against each other: one normal is turned.
    const double dot = glm::dot(normal, other) * (upward == otherUpward ? -1 : 1);
    crease = crease || dot < cosine;
  }
};

using EdgeUses = std::unordered_map<std::uint64_t, EdgeUse>;

std::uint64_t edgeKey(std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<std::uint64_t>(low) << 32) | high;
}

EdgeUses edgeUses(const DesignModel& model, const DesignElement& element, double cosine, double weld) {
  EdgeUses uses;
  Welder welder(model.vertices, weld);
  for (std::uint32_t i = 0; i + 2 < element.indexCount; i += 3) {
    std::array<std::uint32_t, 3> corner;
    for (int c = 0; c < 3; ++c) corner[c] = welder.canonical(model.triangles[element.firstIndex + i + c]);
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
    const glm::dvec3 a(model.vertices[corner[0]]), b(model.vertices[corner[1]]), c(model.vertices[corner[2]]);
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    if (!(length > 0)) continue;
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t from = corner[side], to = corner[(side + 1) % 3];
      uses[edgeKey(from, to)].add(cross / length, from < to, cosine);
    }
  }
  return uses;
}

/// Vertices of `candidates` inside the edge from a to b, in order along it.
std::vector<std::uint32_t> verticesOn(std::uint32_t a, std::uint32_t b, const std::vector<std::uint32_t>& candidates,
                                      const std::vector<glm::vec3>& vertices, double weld) {
  const glm::dvec3 start(vertices[a]), way = glm::dvec3(vertices[b]) - start;
  const double length = glm::length(way);
  std::vector<std::pair<double, std::uint32_t>> found;
  for (const std::uint32_t v : candidates) {
    if (v == a || v == b) continue;
    const glm::dvec3 offset = glm::dvec3(vertices[v]) - start;
    const double along = glm::dot(offset, way) / length;
    if (along > weld && along < length - weld && glm::length(offset - way * (along / length)) <= weld)
      found.emplace_back(along, v);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::uint32_t> result;
  for (const auto& each : found) result.push_back(each.second);
  return result;
}

/// Where one long edge meets several short ones (T-junctions, as solids cut out of each other have them),
/// each has one triangle and looks like a border. The long ones are cut at the vertices on them, so that
/// the pieces find their partners.
void cutAtJunctions(EdgeUses& uses, const std::vector<glm::vec3>& vertices, double cosine, double weld) {
  constexpr std::size_t kMost = 4000;  // the search is quadratic, and a surface with more is truly open
  std::vector<std::uint64_t> borders;
  std::vector<std::uint32_t> ends;
  for (const auto& [key, use] : uses) {
    if (use.count != 1) continue;
    borders.push_back(key);
    ends.push_back(static_cast<std::uint32_t>(key >> 32));
    ends.push_back(static_cast<std::uint32_t>(key));
  }
  if (borders.size() > kMost) return;
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  for (const std::uint64_t key : borders) {
    const auto low = static_cast<std::uint32_t>(key >> 32), high = static_cast<std::uint32_t>(key);
    std::vector<std::uint32_t> path = verticesOn(low, high, ends, vertices, weld);
    if (path.empty()) continue;
    const EdgeUse use = uses[key];
    uses.erase(key);
    path.push_back(high);
    std::uint32_t from = low;
    for (const std::uint32_t to : path) {
      // The piece runs the way the whole did, whichever of its ends has the lower index.
      uses[edgeKey(from, to)].add(use.normal, use.upward == (from < to), cosine);
      from = to;
    }
  }
}

}  // namespace

void findFeatureEdges(DesignModel& model, double creaseAngle, double weld) {
  model.edges.clear();
  const double cosine = std::cos(creaseAngle);
  for (DesignElement& element : model.elements) {
    element.firstEdge = static_cast<std::uint32_t>(model.edges.size());
    EdgeUses uses = edgeUses(model, element, cosine, weld);
    cutAtJunctions(uses, model.vertices, cosine, weld);
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
