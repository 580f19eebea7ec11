// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/subdivision.h"

#include <algorithm>
#include <cmath>

namespace alidade {

namespace {

constexpr int kDeepest = 18;  // halvings of one source edge
constexpr int kPlanes = 5;

/// Signed distance to a plane of the lens's frustum, not normalised; >= 0 inside.
double planeDistance(const LensError& lens, const glm::dvec3& p, int plane) {
  switch (plane) {
    case 0:
      return p.z - LensError::kNearM;
    case 1:
      return p.x - lens.low().x * p.z;
    case 2:
      return lens.high().x * p.z - p.x;
    case 3:
      return p.y - lens.low().y * p.z;
    default:
      return lens.high().y * p.z - p.y;
  }
}

/// The clip of a convex polygon by one plane (Sutherland and Hodgman 1974). The crossing is computed
/// from the inner to the outer point, so that it does not depend on the direction of travel.
void clipByPlane(const LensError& lens, int plane, std::vector<glm::dvec3>& polygon,
                 std::vector<glm::dvec3>& spare) {
  spare.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3& a = polygon[i];
    const glm::dvec3& b = polygon[(i + 1) % polygon.size()];
    const double da = planeDistance(lens, a, plane), db = planeDistance(lens, b, plane);
    if (da >= 0) spare.push_back(a);
    if ((da >= 0) == (db >= 0)) continue;
    const glm::dvec3& in = da >= 0 ? a : b;
    const glm::dvec3& out = da >= 0 ? b : a;
    const double din = da >= 0 ? da : db, dout = da >= 0 ? db : da;
    glm::dvec3 crossing = in + (out - in) * (din / (din - dout));
    if (plane == 0) crossing.z = LensError::kNearM;
    spare.push_back(crossing);
  }
  polygon.swap(spare);
}

double distanceToAxis2(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d = b - a;
  const double length2 = glm::dot(d, d);
  const double t = length2 > 0 ? std::clamp(-glm::dot(a, d) / length2, 0.0, 1.0) : 0.0;
  const glm::dvec2 nearest = a + t * d;
  return glm::dot(nearest, nearest);
}

/// An edge with an end outside the domain is halved until it is short against the domain's border.
bool needsSplitAtBorder(const LensError& lens, const LensPoint& a, const LensPoint& b, bool insideA,
                        bool insideB) {
  if (insideA && insideB) return lens.needsSplit(a, b);
  const glm::dvec2 d = b.n - a.n;
  const double longest = lens.radius() / 24;
  return glm::dot(d, d) > longest * longest && distanceToAxis2(a.n, b.n) < lens.radius() * lens.radius();
}

bool isBeyondBox(const LensError& lens, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const glm::dvec2 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
  return low.x > lens.high().x || low.y > lens.high().y || high.x < lens.low().x || high.y < lens.low().y;
}

/// True where a triangle with all corners outside cannot reach the domain.
bool missesDisc(const LensError& lens, const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const double r2 = lens.radius() * lens.radius();
  if (distanceToAxis2(a, b) < r2 || distanceToAxis2(b, c) < r2 || distanceToAxis2(c, a) < r2) return false;
  const auto turn = [](const glm::dvec2& p, const glm::dvec2& q) { return p.x * q.y - p.y * q.x; };
  const double ab = turn(a, b), bc = turn(b, c), ca = turn(c, a);
  const bool holdsAxis = (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
  return !holdsAxis;
}

}  // namespace

unsigned frustumCode(const LensError& lens, const glm::dvec3& p) {
  unsigned code = 0;
  for (int plane = 0; plane < kPlanes; ++plane)
    if (!(planeDistance(lens, p, plane) >= 0)) code |= 1u << plane;
  return code;
}

LensPoint lensBorder(const LensError& lens, const LensPoint& inside, const LensPoint& outside) {
  double low = 0, high = 1;
  LensPoint border = inside;
  for (int step = 0; step < 40; ++step) {
    const double t = 0.5 * (low + high);
    const LensPoint candidate = LensPoint::of(inside.p + t * (outside.p - inside.p));
    if (lens.inside(candidate.n)) {
      low = t;
      border = candidate;
    } else {
      high = t;
    }
  }
  return border;
}

SurfaceSplitter::SurfaceSplitter(const LensError& lens, std::size_t budget)
    : m_lens(lens), m_budget(budget) {}

void SurfaceSplitter::add(const std::array<glm::dvec3, 3>& triangle, std::uint32_t element) {
  unsigned any = 0, all = ~0u;
  for (const glm::dvec3& p : triangle) {
    const unsigned code = frustumCode(m_lens, p);
    any |= code;
    all &= code;
  }
  if (all != 0) return;
  const glm::dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
  const double length = glm::length(normal);
  if (!(length > 0)) return;
  m_normal = glm::vec3(normal / length);
  m_element = element;
  if (any == 0) {
    split(LensPoint::of(triangle[0]), LensPoint::of(triangle[1]), LensPoint::of(triangle[2]), 0);
    return;
  }
  std::vector<glm::dvec3> polygon(triangle.begin(), triangle.end()), spare;
  for (int plane = 0; plane < kPlanes && !polygon.empty(); ++plane)
    if (any & (1u << plane) || plane > 0) clipByPlane(m_lens, plane, polygon, spare);
  for (std::size_t i = 2; i < polygon.size(); ++i)
    split(LensPoint::of(polygon[0]), LensPoint::of(polygon[i - 1]), LensPoint::of(polygon[i]), 0);
}

void SurfaceSplitter::split(const LensPoint& a, const LensPoint& b, const LensPoint& c, int depth) {
  if (isBeyondBox(m_lens, a.n, b.n, c.n)) return;
  const bool insideA = m_lens.inside(a.n), insideB = m_lens.inside(b.n), insideC = m_lens.inside(c.n);
  const bool whole = insideA && insideB && insideC;
  const bool exhausted = depth >= 2 * kDeepest || indices.size() / 3 >= m_budget;
  if (whole) {
    const std::array<bool, 3> edges{m_lens.needsSplit(a, b), m_lens.needsSplit(b, c),
                                    m_lens.needsSplit(c, a)};
    if (exhausted || !(edges[0] || edges[1] || edges[2])) return emit(a, b, c);
    return splitAt({a, b, c}, edges, depth);
  }
  if (!insideA && !insideB && !insideC && missesDisc(m_lens, a.n, b.n, c.n)) return;
  const std::array<bool, 3> edges{needsSplitAtBorder(m_lens, a, b, insideA, insideB),
                                  needsSplitAtBorder(m_lens, b, c, insideB, insideC),
                                  needsSplitAtBorder(m_lens, c, a, insideC, insideA)};
  if (exhausted || !(edges[0] || edges[1] || edges[2])) return clipToLens({a, b, c}, depth);
  splitAt({a, b, c}, edges, depth);
}

/// Halves the marked edges (0: ab, 1: bc, 2: ca) and goes on with the two to four pieces.
void SurfaceSplitter::splitAt(const std::array<LensPoint, 3>& corners, const std::array<bool, 3>& edges,
                              int depth) {
  const int count = edges[0] + edges[1] + edges[2];
  // Turned so that with one mark it is on ab, and with two the free edge is ca.
  int first = 0;
  if (count == 1) first = edges[0] ? 0 : edges[1] ? 1 : 2;
  if (count == 2) first = !edges[2] ? 0 : !edges[0] ? 1 : 2;
  const LensPoint& a = corners[first];
  const LensPoint& b = corners[(first + 1) % 3];
  const LensPoint& c = corners[(first + 2) % 3];
  const LensPoint ab = bisect(a, b);
  if (count == 1) {
    split(a, ab, c, depth + 1);
    split(ab, b, c, depth + 1);
    return;
  }
  const LensPoint bc = bisect(b, c);
  if (count == 2) {
    split(ab, b, bc, depth + 1);
    split(a, ab, bc, depth + 1);
    split(a, bc, c, depth + 1);
    return;
  }
  const LensPoint ca = bisect(c, a);
  split(a, ab, ca, depth + 1);
  split(ab, b, bc, depth + 1);
  split(ca, bc, c, depth + 1);
  split(ab, bc, ca, depth + 1);
}

/// Keeps the part of a small triangle that the lens sees; its border becomes straight there.
void SurfaceSplitter::clipToLens(const std::array<LensPoint, 3>& corners, int depth) {
  std::vector<LensPoint> polygon;
  for (int i = 0; i < 3; ++i) {
    const LensPoint& a = corners[i];
    const LensPoint& b = corners[(i + 1) % 3];
    const bool insideA = m_lens.inside(a.n), insideB = m_lens.inside(b.n);
    if (insideA) polygon.push_back(a);
    if (insideA != insideB) polygon.push_back(insideA ? lensBorder(m_lens, a, b) : lensBorder(m_lens, b, a));
  }
  // Deep enough that the pieces, all inside now, end; in a domain that is not round a chord may still
  // leave it by less than a pixel.
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    if (m_lens.isRound())
      split(polygon[0], polygon[i - 1], polygon[i], depth + 1);
    else
      emit(polygon[0], polygon[i - 1], polygon[i]);
  }
}

/// Takes a corner over from the last pieces where it is the same, as in the two triangles of a rectangle.
void SurfaceSplitter::emit(const LensPoint& a, const LensPoint& b, const LensPoint& c) {
  constexpr std::size_t remembered = 4;
  for (const LensPoint* corner : {&a, &b, &c}) {
    const glm::vec3 p(corner->p);
    std::size_t found = vertices.size();
    for (std::size_t back = 1; back <= std::min(remembered, vertices.size()); ++back) {
      const SurfaceVertex& v = vertices[vertices.size() - back];
      if (v.pInCamera == p && v.element == m_element && glm::dot(v.normal, m_normal) > 0.999999f)
        found = vertices.size() - back;
    }
    indices.push_back(static_cast<std::uint32_t>(found));
    if (found == vertices.size()) vertices.push_back({p, m_normal, m_element});
  }
}

EdgeSplitter::EdgeSplitter(const LensError& lens, std::size_t budget) : m_lens(lens), m_budget(budget) {}

void EdgeSplitter::add(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t element, double along) {
  const unsigned codeA = frustumCode(m_lens, a), codeB = frustumCode(m_lens, b);
  if (codeA & codeB) return;
  glm::dvec3 from = a, to = b;
  for (int plane = 0; plane < kPlanes && (codeA | codeB); ++plane) {
    const double da = planeDistance(m_lens, from, plane), db = planeDistance(m_lens, to, plane);
    if (da < 0 && db < 0) return;
    if ((da >= 0) == (db >= 0)) continue;
    glm::dvec3 crossing = from + (to - from) * (da / (da - db));
    if (plane == 0) crossing.z = LensError::kNearM;
    (da < 0 ? from : to) = crossing;
  }
  m_start = a;
  m_along = along;
  m_element = element;
  split(LensPoint::of(from), LensPoint::of(to), 0);
}

void EdgeSplitter::split(const LensPoint& a, const LensPoint& b, int depth) {
  if (isBeyondBox(m_lens, a.n, b.n, b.n)) return;
  const bool insideA = m_lens.inside(a.n), insideB = m_lens.inside(b.n);
  if (!insideA && !insideB && distanceToAxis2(a.n, b.n) >= m_lens.radius() * m_lens.radius()) return;
  const bool exhausted = depth >= kDeepest || vertices.size() / 2 >= m_budget;
  if (!exhausted && needsSplitAtBorder(m_lens, a, b, insideA, insideB)) {
    const LensPoint middle = bisect(a, b);
    split(a, middle, depth + 1);
    split(middle, b, depth + 1);
    return;
  }
  if (!insideA && !insideB) return;
  if (insideA != insideB) {
    const LensPoint border = insideA ? lensBorder(m_lens, a, b) : lensBorder(m_lens, b, a);
    if (glm::length(border.p - (insideA ? a.p : b.p)) > 1e-9 && depth < kDeepest) {
      if (insideA) split(a, border, depth + 1);
      if (insideB) split(border, b, depth + 1);
    }
    return;
  }
  if (m_lens.sagBound(a, b) > worstErrorPx) worstErrorPx = std::max(worstErrorPx, m_lens.sag(a, b).across);
  for (const LensPoint* end : {&a, &b})
    vertices.push_back({glm::vec3(end->p), m_element, static_cast<float>(m_along + glm::length(end->p - m_start))});
}

}  // namespace alidade
