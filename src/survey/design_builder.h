// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/error.h"
#include "survey/design_model.h"

namespace alidade {

/// Collects a design's triangles in double precision and makes the DesignModel of them: one origin near
/// the middle, float vertices around it, shared vertices, no degenerate triangles, feature edges.
class DesignBuilder {
 public:
  /// The following triangles belong to this element; its ranges are set by finish().
  void beginElement(DesignElement element);
  /// World metres, counter-clockwise from outside. Needs an element begun.
  void addTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);
  /// Triangles of the current element so far.
  std::size_t triangleCount() const { return m_parts.empty() ? 0 : m_parts.back().corners.size() / 3; }
  /// Sets the current element's colour, for readers that learn it with the geometry.
  void setColour(const Rgba8& colour) { m_parts.back().element.colour = colour; }
  /// Drops the current element and its triangles.
  void dropElement() { m_parts.pop_back(); }

  struct Summary {
    std::size_t degenerate = 0;     ///< triangles left out: no area
    std::size_t notFinite = 0;      ///< triangles left out: a coordinate is no number, or beyond 10⁹ m
    std::size_t emptyElements = 0;  ///< elements left out: no triangle left
  };

  /// Error where no triangle is left or a limit of 32-bit indices is passed. The builder is empty after.
  Result<DesignModel> finish(Summary& summary);

 private:
  struct Part {
    DesignElement element;
    std::vector<glm::dvec3> corners;
  };
  std::vector<Part> m_parts;
};

/// Six times the signed volume that the triangles enclose, summed relative to the first corner so that
/// far-away coordinates cost no digits; positive where a closed surface is wound counter-clockwise.
double sixfoldVolume(const std::vector<std::array<glm::dvec3, 3>>& triangles);

}  // namespace alidade
