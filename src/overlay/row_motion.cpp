// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/row_motion.h"

#include <algorithm>
#include <cmath>

namespace alidade {

RowMotion::RowMotion(const Camera& camera, const RollingShutter& shutter, double allowedPx)
    : m_camera(camera), m_shutter(shutter), m_allowedPx(allowedPx), m_reach(1.5 * camera.imageRadius()) {}

/// As pointAtItsRow, but for every place: what the lens does not see moves with the row of the nearest place that it
/// does, so that lines which come into the picture from there stay whole, and nothing jumps.
glm::dvec3 RowMotion::moved(const glm::dvec3& p) const {
  const int height = m_camera.height();
  const double reach = 0.98 * std::min(m_camera.foldBackRadius(), 1.3 * m_camera.imageRadius());
  double row = 0.5 * (height - 1);
  glm::dvec3 at = p;
  for (int step = 0; step < 12; ++step) {
    glm::dvec2 n = glm::dvec2(at) / std::max(at.z, 0.25 * kNearM);
    if (const double r = glm::length(n); r > reach) n *= reach / r;
    const auto pixel = m_camera.project({n, 1.0});
    const double next = std::clamp(pixel ? pixel->y : n.y < 0 ? -1e9 : 1e9, -0.5 * height, 1.5 * height);
    if (std::abs(next - row) < 1e-3) break;
    row = next;
    at = exponential(m_shutter.motion * m_shutter.secsAtRow(row, height)) * p;
  }
  return at;
}

/// The moved middle against the line that a device draws between the moved ends, on the image plane. The middle of
/// the line in space is not that of its picture, so only what lies across counts.
double RowMotion::errorPx(const End& a, const End& b, const End& middle) const {
  const auto plane = [](const glm::dvec3& p) { return glm::dvec2(p) / std::max(p.z, 0.25 * kNearM); };
  const glm::dvec2 from = plane(a.moved), along = plane(b.moved) - from, there = plane(middle.moved) - from;
  const double length = glm::length(along);
  const double across = length > 0 ? std::abs(along.x * there.y - along.y * there.x) / length : glm::length(there);
  return across * m_camera.intrinsics().fx;
}

/// Signed distance to a plane of the clip: before the camera, and within reach to the four sides; >= 0 inside.
double RowMotion::planeDistance(const glm::dvec3& p, int plane) const {
  switch (plane) {
    case 0: return p.z - kNearM;
    case 1: return m_reach * p.z - p.x;
    case 2: return m_reach * p.z + p.x;
    case 3: return m_reach * p.z - p.y;
    default: return m_reach * p.z + p.y;
  }
}

/// After Sutherland and Hodgman (1974); crossings from the inner to the outer point, so that both triangles of an edge
/// get the same.
void RowMotion::clip(std::vector<glm::dvec3>& polygon) const {
  std::vector<glm::dvec3> kept;
  for (int plane = 0; plane < kPlanes && !polygon.empty(); ++plane) {
    kept.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const double da = planeDistance(a, plane), db = planeDistance(b, plane);
      if (da >= 0) kept.push_back(a);
      if ((da >= 0) == (db >= 0)) continue;
      kept.push_back(da >= 0 ? a + (b - a) * (da / (da - db)) : b + (a - b) * (db / (db - da)));
    }
    polygon.swap(kept);
  }
}

bool RowMotion::clipLine(glm::dvec3& from, glm::dvec3& to) const {
  for (int plane = 0; plane < kPlanes; ++plane) {
    const double da = planeDistance(from, plane), db = planeDistance(to, plane);
    if (da < 0 && db < 0) return false;
    if ((da >= 0) == (db >= 0)) continue;
    (da < 0 ? from : to) = da >= 0 ? from + (to - from) * (da / (da - db)) : to + (from - to) * (db / (db - da));
  }
  return true;
}

}  // namespace alidade
