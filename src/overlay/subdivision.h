// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "overlay/draw_list.h"
#include "overlay/lens_error.h"

namespace alidade {

/// Cuts triangles to what the lens sees and splits them until every edge is drawn within the allowed
/// error. Whether and where an edge is split follows from its two ends alone, so that neighbours stay
/// joined. Not thread-safe; one a thread.
class SurfaceSplitter {
 public:
  /// `budget`: pieces after which nothing is split any more, whatever the error.
  SurfaceSplitter(const LensError& lens, std::size_t budget);

  /// One triangle in camera axes, metres; all finite.
  void add(const std::array<glm::dvec3, 3>& triangle, std::uint32_t element);

  std::vector<SurfaceVertex> vertices;
  std::vector<std::uint32_t> indices;

 private:
  void split(const LensPoint& a, const LensPoint& b, const LensPoint& c, int depth);
  void splitAt(const std::array<LensPoint, 3>& corners, const std::array<bool, 3>& edges, int depth);
  void clipToLens(const std::array<LensPoint, 3>& corners, int depth);
  void emit(const LensPoint& a, const LensPoint& b, const LensPoint& c);

  const LensError& m_lens;
  std::size_t m_budget;
  glm::vec3 m_normal{0};
  std::uint32_t m_element = 0;
};

/// The same for lines.
class EdgeSplitter {
 public:
  EdgeSplitter(const LensError& lens, std::size_t budget);

  /// `along`: metres from the edge's start to `a`, for dashes.
  void add(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t element, double along = 0);

  std::vector<EdgeVertex> vertices;  ///< pairs
  double worstErrorPx = 0;

 private:
  void split(const LensPoint& a, const LensPoint& b, int depth);

  const LensError& m_lens;
  std::size_t m_budget;
  glm::dvec3 m_start{0};
  double m_along = 0;
  std::uint32_t m_element = 0;
};

/// Bits of the planes that a point lies beyond: near, left, right, top, bottom of the lens's box.
unsigned frustumCode(const LensError& lens, const glm::dvec3& p);

/// Where the line from a (inside) to b (outside) leaves the lens's domain, a little inside of it. The
/// same for both triangles at an edge.
LensPoint lensBorder(const LensError& lens, const LensPoint& inside, const LensPoint& outside);

}  // namespace alidade
