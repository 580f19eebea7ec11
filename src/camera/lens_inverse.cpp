// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "camera/lens_domain.h"

namespace alidade {

namespace {

constexpr double accuracy = 1e-12;  // of a residual in normalised coordinates: 1e-8 px at f = 10 000 px
constexpr double farthestRadius = 1e4;

double tolerance(const glm::dvec2& target) {
  return accuracy * (1 + glm::length(target));
}

}  // namespace

/// Newton's method on the monotone r radial(r), kept inside a shrinking bracket.
std::optional<double> LensDomain::inverseRadius(double distortedRadius) const {
  if (!(distortedRadius >= 0) || !std::isfinite(distortedRadius)) return std::nullopt;
  if (distortedRadius == 0) return 0.0;
  const auto at = [&](double r) {
    Dual2 x, y;
    distort(m_radial, Dual2{r, 1, 0}, Dual2{0, 0, 1}, x, y);
    return x;
  };
  double low = 0, high = m_radialLimit;
  if (std::isinf(high)) {
    high = std::max(1.0, distortedRadius);
    while (at(high).value < distortedRadius && high < farthestRadius) high *= 2;
  }
  // At a pole the value itself is no number; everything below it is reached.
  const double top = at(high).value;
  if (top < distortedRadius) return std::nullopt;

  double r = std::min(distortedRadius, 0.5 * high);
  for (int i = 0; i < 200 && low < high; ++i) {
    const Dual2 g = at(r);
    if (g.value == distortedRadius) return r;
    (g.value < distortedRadius ? low : high) = r;
    double next = r + (distortedRadius - g.value) / g.dx;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == r || next <= low || next >= high) break;
    r = next;
  }
  return r;
}

/// The sensor's tilt is a homography, undone exactly.
std::optional<glm::dvec2> LensDomain::withoutTilt(const glm::dvec2& distorted) const {
  if (!m_lens.tilted) return distorted;
  const auto& m = m_lens.tilt;
  const glm::dmat3 tilt(m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]);
  const glm::dvec3 back = glm::inverse(tilt) * glm::dvec3(distorted, 1);
  if (!(back.z > 0)) return std::nullopt;
  return glm::dvec2(back) / back.z;
}

/// The radial factor undone alone, then drawn towards the axis until it lies in the domain.
glm::dvec2 LensDomain::startFor(const glm::dvec2& flat) const {
  const double distortedRadius = glm::length(flat);
  if (!(distortedRadius > 0)) return flat;
  const double fallback = std::min(m_radialLimit * 0.98, farthestRadius);
  glm::dvec2 start = flat * (inverseRadius(distortedRadius).value_or(fallback) / distortedRadius);
  for (int i = 0; i < 60 && !contains(start.x, start.y); ++i) start *= 0.9;
  return start;
}

/// Damped Newton from p: a step is halved until it stays in the domain and comes closer.
std::optional<glm::dvec2> LensDomain::descend(glm::dvec2 p, const glm::dvec2& target) const {
  DistortedPoint at = jacobianOf(m_flat, p);
  double error = glm::length(at.position - target);
  for (int i = 0; i < 100 && error > 0; ++i) {
    const glm::dvec2 f = target - at.position;
    const double determinant = at.determinant();
    if (!(determinant > 0)) break;
    const glm::dvec2 step((f.x * at.dy.y - f.y * at.dy.x) / determinant, (f.y * at.dx.x - f.x * at.dx.y) / determinant);
    bool closer = false;
    for (double share = 1; share > 1e-6 && !closer; share *= 0.5) {
      const glm::dvec2 next = p + share * step;
      if (next == p) break;
      if (!contains(next.x, next.y)) continue;
      const DistortedPoint there = jacobianOf(m_flat, next);
      const double nextError = glm::length(there.position - target);
      if (!(nextError < error)) continue;
      closer = true;
      p = next, at = there, error = nextError;
    }
    if (!closer) break;
  }
  if (!(error <= tolerance(target)) || !contains(p.x, p.y)) return std::nullopt;
  return p;
}

/// Follows the inverse from p, where it is known, along the straight line to the target, in steps as
/// long as Newton's method bears.
std::optional<glm::dvec2> LensDomain::continued(glm::dvec2 p, const glm::dvec2& target) const {
  const glm::dvec2 origin = jacobianOf(m_flat, p).position;
  double done = 0, step = 0.25;
  while (done < 1) {
    const double reach = std::min(1.0, done + step);
    if (const auto next = descend(p, glm::mix(origin, target, reach))) {
      p = *next;
      done = reach;
      step *= 2;
    } else {
      step *= 0.5;
      if (step < 1e-3) return std::nullopt;
    }
  }
  return p;
}

std::optional<glm::dvec2> LensDomain::undistorted(const glm::dvec2& distorted) const {
  if (!std::isfinite(distorted.x) || !std::isfinite(distorted.y)) return std::nullopt;
  if (m_lens.kind == LensKind::None) return distorted;
  if (!m_bent) {
    const double distortedRadius = glm::length(distorted);
    if (distortedRadius == 0) return glm::dvec2(0);
    const auto r = inverseRadius(distortedRadius);
    if (!r) return std::nullopt;
    return distorted * (*r / distortedRadius);
  }
  const auto flat = withoutTilt(distorted);
  if (!flat) return std::nullopt;
  const glm::dvec2 start = startFor(*flat);
  if (const auto p = descend(start, *flat)) return p;
  if (const auto p = continued(start, *flat)) return p;
  return continued(glm::dvec2(0), *flat);
}

}  // namespace alidade
