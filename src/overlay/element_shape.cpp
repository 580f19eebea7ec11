// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/element_shape.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <mutex>

#include "base/parallel.h"

namespace alidade {

namespace {

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

std::uint64_t hashOf(const glm::vec3& p) {
  std::uint64_t hash = 0x9e3779b97f4a7c15ull;
  for (int k = 0; k < 3; ++k) hash = mixed(hash + std::bit_cast<std::uint32_t>(p[k] + 0.0f));  // -0 is 0
  return hash;
}

struct Entry {
  std::weak_ptr<const DesignModel> model;
  std::shared_ptr<const std::vector<ElementShape>> shapes;
};

}  // namespace

ElementShape shapeOf(const DesignModel& model, const DesignElement& element) {
  if (std::size_t{element.firstIndex} + element.indexCount > model.triangles.size()) return {};
  ElementShape shape;
  std::uint64_t unpaired = 0;
  double volume6 = 0;
  double reach = 0;
  glm::dvec3 middle(0);
  for (std::uint32_t i = 0; i + 2 < element.indexCount; i += 3) {
    const std::uint32_t* corner = model.triangles.data() + element.firstIndex + i;
    glm::dvec3 p[3];
    std::uint64_t hash[3];
    for (int k = 0; k < 3; ++k) {
      if (corner[k] >= model.vertices.size()) return {};
      const glm::vec3& vertex = model.vertices[corner[k]];
      hash[k] = hashOf(vertex);
      if (i == 0 && k == 0) middle = vertex;
      p[k] = glm::dvec3(vertex) - middle;
      reach = std::max(reach, glm::length(p[k]));
    }
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t a = hash[k], b = hash[(k + 1) % 3];
      const std::uint64_t edge = mixed(mixed(std::min(a, b)) + std::max(a, b));
      unpaired += a < b ? edge : -edge;
    }
    volume6 += glm::dot(p[0], glm::cross(p[1], p[2]));
    shape.area += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  }
  constexpr double leastShare = 1e-9;  // of the cube about it: flatter is no solid
  if (unpaired == 0 && std::abs(volume6) > leastShare * reach * reach * reach)
    shape.winding = volume6 > 0 ? Winding::Outwards : Winding::Inwards;
  return shape;
}

std::shared_ptr<const std::vector<ElementShape>> shapesOf(const std::shared_ptr<const DesignModel>& model) {
  static std::mutex mutex;
  static std::map<const DesignModel*, Entry> known;
  if (!model) return std::make_shared<std::vector<ElementShape>>();
  {
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(model.get());
        found != known.end() && found->second.model.lock() == model)
      return found->second.shapes;
  }
  auto shapes = std::make_shared<std::vector<ElementShape>>(model->elements.size());
  parallelFor(model->elements.size(), 16, [&](std::size_t first, std::size_t last, int) {
    for (std::size_t e = first; e < last; ++e) (*shapes)[e] = shapeOf(*model, model->elements[e]);
  });
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const auto& entry) { return entry.second.model.expired(); });
  known[model.get()] = {model, shapes};
  return shapes;
}

std::uint32_t hiddenRank(double area) {
  if (!(area > 0)) return 63;
  return static_cast<std::uint32_t>(std::clamp(31.5 - 2 * std::log2(area), 0.0, 63.0));
}

}  // namespace alidade
