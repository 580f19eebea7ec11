// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "camera/rolling_shutter.h"

namespace alidade {

/// Carries geometry from the axes of a frame's middle row to where it stands when its own rows are read, so that whoever
/// draws it need not know of rolling shutters. A straight line does not stay one: it is cut until every piece is
/// within the allowed error of its curve. Where an edge is cut follows from its two ends alone, so that
/// neighbours stay joined.
class RowMotion {
 public:
  /// Both must outlive it.
  RowMotion(const Camera& camera, const RollingShutter& shutter, double allowedPx);

  bool isOn() const { return m_shutter.isOn(); }

  /// Calls emit(triangle) with moved pieces of what of a triangle may come into the picture.
  template <class Emit>
  void surface(const std::array<glm::dvec3, 3>& triangle, const Emit& emit) const {
    std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end());
    clip(polygon);
    for (std::size_t i = 2; i < polygon.size(); ++i) splitSurface({end(polygon[0]), end(polygon[i - 1]), end(polygon[i])}, 0, emit);
  }

  /// Calls emit(a, b, alongA) with moved pieces of a line; alongA: metres from its start.
  template <class Emit>
  void edge(const glm::dvec3& a, const glm::dvec3& b, const Emit& emit) const {
    glm::dvec3 from = a, to = b;
    if (clipLine(from, to)) splitEdge(end(from), end(to), a, 0, emit);
  }

 private:
  static constexpr double kNearM = 0.02;  ///< before the device's own near plane
  static constexpr int kPlanes = 5;
  static constexpr int kDeepest = 7;  ///< halvings of an edge

  struct End {
    glm::dvec3 still, moved;
  };

  glm::dvec3 moved(const glm::dvec3& p) const;
  End end(const glm::dvec3& still) const { return {still, moved(still)}; }
  End middle(const End& a, const End& b) const { return end(0.5 * (a.still + b.still)); }
  double errorPx(const End& a, const End& b, const End& middle) const;
  double planeDistance(const glm::dvec3& p, int plane) const;
  void clip(std::vector<glm::dvec3>& polygon) const;
  bool clipLine(glm::dvec3& from, glm::dvec3& to) const;

  template <class Emit>
  void splitSurface(const std::array<End, 3>& corners, int depth, const Emit& emit) const {
    // The worst edge first: any order ends with the same cuts along the edges, but others leave slivers between.
    std::array<End, 3> half;
    std::size_t worst = 0;
    std::array<double, 3> error{};
    for (std::size_t i = 0; i < 3; ++i) {
      half[i] = middle(corners[i], corners[(i + 1) % 3]);
      error[i] = errorPx(corners[i], corners[(i + 1) % 3], half[i]);
      if (error[i] > error[worst]) worst = i;
    }
    if (depth < 2 * kDeepest && error[worst] > m_allowedPx) {
      const End &a = corners[worst], &b = corners[(worst + 1) % 3], &c = corners[(worst + 2) % 3];
      splitSurface({a, half[worst], c}, depth + 1, emit);
      splitSurface({half[worst], b, c}, depth + 1, emit);
      return;
    }
    emit(std::array<glm::dvec3, 3>{corners[0].moved, corners[1].moved, corners[2].moved});
  }

  template <class Emit>
  void splitEdge(const End& a, const End& b, const glm::dvec3& start, int depth, const Emit& emit) const {
    const End half = middle(a, b);
    if (depth >= kDeepest || errorPx(a, b, half) <= m_allowedPx) return emit(a.moved, b.moved, glm::length(a.still - start));
    splitEdge(a, half, start, depth + 1, emit);
    splitEdge(half, b, start, depth + 1, emit);
  }

  const Camera& m_camera;
  const RollingShutter& m_shutter;
  double m_allowedPx;
  double m_reach = 0;  ///< on the image plane, of what may come into the picture
};

}  // namespace alidade
