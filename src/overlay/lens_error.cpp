// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "overlay/lens_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "camera/lens_kernel.h"

namespace alidade {

namespace {

// tan(89.94°): beyond, the flat image plane is no measure any more, and no lens in use sees there.
constexpr double kWidestRadius = 1000.0;

bool isBefore(const glm::dvec3& a, const glm::dvec3& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

}  // namespace

LensPoint bisect(const LensPoint& a, const LensPoint& b) {
  const LensPoint* first = &a;
  const LensPoint* second = &b;
  if (isBefore(b.p, a.p)) std::swap(first, second);
  const double lengthFirst = glm::length(first->p), lengthSecond = glm::length(second->p);
  return LensPoint::of((first->p * lengthSecond + second->p * lengthFirst) / (lengthFirst + lengthSecond));
}

LensError::LensError(const Camera& camera, double allowedPx)
    : m_camera(camera), m_allowedPx(std::clamp(allowedPx, 1e-3, 100.0)) {
  const double fold = camera.foldBackRadius();
  m_radius = std::min({fold * (1 - 1e-9), camera.imageRadius() * 1.05, kWidestRadius});
  m_foldsInPicture = fold < camera.imageRadius() * 1.05;
  m_safeRadius = m_radius;
  // A lens that is not round ends at another radius on each side.
  constexpr int rays = 256;
  for (int i = 0; i < rays; ++i) {
    const double limit = camera.domain().limitAlong(2 * std::numbers::pi * i / rays);
    if (limit < m_radius) m_safeRadius = std::min(m_safeRadius, 0.95 * limit);
  }
  if (!isRound()) m_foldsInPicture = true;
  findBox();
  findCurvature();
}

void LensError::findBox() {
  m_low = glm::dvec2(-m_radius);
  m_high = glm::dvec2(m_radius);
  glm::dvec2 low(1e300), high(-1e300);
  constexpr int steps = 48;
  const double w = m_camera.width(), h = m_camera.height();
  for (int i = 0; i <= 4 * steps; ++i) {
    const double t = static_cast<double>(i % steps) / steps;
    const int side = (i / steps) % 4;
    const glm::dvec2 pixel = side == 0   ? glm::dvec2(t * w, 0)
                             : side == 1 ? glm::dvec2(w, t * h)
                             : side == 2 ? glm::dvec2(w - t * w, h)
                                         : glm::dvec2(0, h - t * h);
    const auto ray = m_camera.unproject(pixel - 0.5);
    if (!ray) return;  // the border is not seen: the circle bounds what is
    low = glm::min(low, glm::dvec2(*ray));
    high = glm::max(high, glm::dvec2(*ray));
  }
  const glm::dvec2 margin = 0.03 * (high - low) + 1e-6;
  m_low = glm::max(m_low, low - margin);
  m_high = glm::min(m_high, high + margin);
}

glm::dvec2 LensError::pixel(const glm::dvec2& n) const {
  double x = 0, y = 0;
  distort(m_camera.lens(), n.x, n.y, x, y);
  const Intrinsics& in = m_camera.intrinsics();
  return {in.fx * x + in.cx, in.fy * y + in.cy};
}

/// Second derivatives of the pixel by the image plane, sampled over the domain: a line of length h
/// sags by at most max|D''| h² / 8.
void LensError::findCurvature() {
  if (m_camera.lens().kind == LensKind::None) return;
  constexpr int rings = 20, spokes = 24;
  const double widest = std::atan(m_radius);
  double largest = 0;
  for (int ring = 0; ring <= rings; ++ring) {
    const double r = std::tan(widest * ring / rings);
    const double e = 1e-3 * std::min(1.0, m_radius) * std::max(1.0, 0.1 * r);
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double angle = 2 * std::numbers::pi * spoke / spokes;
      const glm::dvec2 n = r * glm::dvec2(std::cos(angle), std::sin(angle));
      if (glm::any(glm::lessThan(n, m_low)) || glm::any(glm::greaterThan(n, m_high)) || !inside(n)) continue;
      const glm::dvec2 centre = pixel(n);
      for (const glm::dvec2& d :
           {glm::dvec2(e, 0), glm::dvec2(0, e), glm::dvec2(e, e) * std::numbers::sqrt2 / 2.0,
            glm::dvec2(e, -e) * std::numbers::sqrt2 / 2.0})
        largest = std::max(largest, glm::length(pixel(n + d) - 2.0 * centre + pixel(n - d)) / (e * e));
    }
  }
  constexpr double safety = 1.5;  // for what lies between the samples
  m_curvature = std::isfinite(largest) ? safety * largest / 8 : 1e12;
}

LensError::Sag LensError::sag(const LensPoint& one, const LensPoint& other) const {
  // In a fixed order, so that rounding cannot make neighbours decide differently.
  const bool swapped = isBefore(other.p, one.p);
  const LensPoint& a = swapped ? other : one;
  const LensPoint& b = swapped ? one : other;
  const glm::dvec2 from = pixel(a.n), chord = pixel(b.n) - from;
  const double length = glm::length(chord), planeLength = glm::length(b.n - a.n);
  Sag worst;
  const LensPoint middle = bisect(a, b);
  for (const LensPoint& on : {middle, bisect(a, middle), bisect(middle, b)}) {
    // Interpolation with w = z moves evenly on the undistorted plane.
    const double share = planeLength > 0 ? glm::length(on.n - a.n) / planeLength : 0;
    const glm::dvec2 d = pixel(on.n) - from;
    if (length < 1e-9) {
      worst.across = std::max(worst.across, glm::length(d));
      continue;
    }
    worst.across = std::max(worst.across, std::abs(d.x * chord.y - d.y * chord.x) / length);
    worst.along = std::max(worst.along, std::abs(glm::dot(d, chord) / length - share * length));
  }
  return worst;
}

}  // namespace alidade
