// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "survey/design_builder.h"

#include <bit>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace alidade {

namespace {

constexpr double kFarthest = 1e9;     // metres; beyond it a coordinate is a slip of the file
constexpr double kLeastArea = 1e-12;  // square metres: a micrometre by a micrometre

struct ExactHash {
  std::size_t operator()(const glm::dvec3& v) const noexcept {
    std::uint64_t h = 0x9E3779B97F4A7C15ull;
    for (int i = 0; i < 3; ++i) h = (h ^ std::bit_cast<std::uint64_t>(v[i] + 0.0)) * 0xBF58476D1CE4E5B9ull, h ^= h >> 29;
    return h;
  }
};

bool usable(const glm::dvec3& v) {
  return std::abs(v.x) < kFarthest && std::abs(v.y) < kFarthest && std::abs(v.z) < kFarthest;
}

}  // namespace

void DesignBuilder::beginElement(DesignElement element) {
  m_parts.push_back({std::move(element), {}});
}

void DesignBuilder::addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  auto& corners = m_parts.back().corners;
  corners.insert(corners.end(), {a, b, c});
}

Result<DesignModel> DesignBuilder::finish(Summary& summary) {
  Bounds box;
  for (const Part& part : m_parts)
    for (const glm::dvec3& corner : part.corners)
      if (usable(corner)) box.add(corner);

  DesignModel model;
  // Whole metres, so that the origin itself is exact in every notation.
  if (!box.empty()) model.origin = glm::round(box.centre());
  for (Part& part : m_parts) {
    std::unordered_map<glm::dvec3, std::uint32_t, ExactHash> known;
    DesignElement& element = part.element;
    element.firstIndex = static_cast<std::uint32_t>(model.triangles.size());
    for (std::size_t i = 0; i + 2 < part.corners.size(); i += 3) {
      const glm::dvec3* corner = &part.corners[i];
      if (!usable(corner[0]) || !usable(corner[1]) || !usable(corner[2])) {
        ++summary.notFinite;
        continue;
      }
      if (glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0])) < 2 * kLeastArea) {
        ++summary.degenerate;
        continue;
      }
      for (int c = 0; c < 3; ++c) {
        const auto [place, fresh] = known.emplace(corner[c], static_cast<std::uint32_t>(model.vertices.size()));
        if (fresh) model.vertices.push_back(glm::vec3(corner[c] - model.origin));
        model.triangles.push_back(place->second);
      }
      if (model.triangles.size() > std::numeric_limits<std::uint32_t>::max() - 3)
        return fail("The design has more triangles than can be drawn", {}, "Split the model");
    }
    element.indexCount = static_cast<std::uint32_t>(model.triangles.size()) - element.firstIndex;
    part.corners = {};
    if (element.indexCount == 0) ++summary.emptyElements;
    else model.elements.push_back(std::move(element));
  }
  m_parts.clear();
  if (model.triangles.empty()) return fail("The file holds no surface that could be drawn");
  findFeatureEdges(model);
  return model;
}

double sixfoldVolume(const std::vector<std::array<glm::dvec3, 3>>& triangles) {
  if (triangles.empty()) return 0;
  const glm::dvec3 origin = triangles.front()[0];
  double sum = 0;
  for (const auto& t : triangles) sum += glm::dot(t[0] - origin, glm::cross(t[1] - origin, t[2] - origin));
  return sum;
}

}  // namespace alidade
