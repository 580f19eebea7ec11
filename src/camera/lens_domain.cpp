// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "camera/lens_domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace alidade {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// 89.994 degrees off the axis: no perspective picture reaches there.
constexpr double farthestRadius = 1e4;
constexpr int rayCount = 96;
constexpr int samplesPerRay = 96;

double valueAt(const std::vector<double>& coefficients, double u) {
  double value = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) value = value * u + coefficients[i];
  return value;
}

std::vector<double> signChanges(std::vector<double> coefficients, double upper) {
  while (!coefficients.empty() && coefficients.back() == 0) coefficients.pop_back();
  if (coefficients.size() < 2) return {};
  std::vector<double> derivative(coefficients.size() - 1);
  for (std::size_t i = 1; i < coefficients.size(); ++i) derivative[i - 1] = static_cast<double>(i) * coefficients[i];

  std::vector<double> ends{0};
  for (const double u : signChanges(derivative, upper)) ends.push_back(u);
  ends.push_back(upper);

  std::vector<double> roots;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    double low = ends[i], high = ends[i + 1];
    const bool positive = valueAt(coefficients, low) > 0;
    if ((valueAt(coefficients, high) > 0) == positive) continue;
    while (true) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      ((valueAt(coefficients, middle) > 0) == positive ? low : high) = middle;
    }
    roots.push_back(low);
  }
  return roots;
}

/// First r where d(r radial)/dr stops being positive, from the polynomials of distortion.h with
/// u = r²: d(r N/D)/dr = (N D + 2u (N' D - N D')) / D².
double radialLimitOf(const Distortion& d) {
  if (d.fisheye) {
    // d(theta_d)/dtheta in v = theta²; theta stays below 90 degrees.
    std::vector<double> slope{1};
    for (int i = 0; i < 4; ++i) slope.push_back((2 * i + 3) * d.k[i]);
    const double quarter = 0.5 * std::numbers::pi;
    const auto v = firstSignChange(slope, quarter * quarter);
    const double r = v ? std::tan(std::sqrt(*v)) : infinity;
    return r > 0 && r < farthestRadius ? r : infinity;
  }
  const std::array<double, 7> numerator{1, d.k[0], d.k[1], d.k[2], d.k[3], d.k[4], d.k[5]};
  const std::array<double, 4> denominator{1, d.q[0], d.q[1], d.q[2]};
  std::vector<double> slope(10, 0.0);
  for (int i = 0; i < 7; ++i)
    for (int j = 0; j < 4; ++j) slope[i + j] += numerator[i] * denominator[j] * (1 + 2 * i - 2 * j);

  const double upper = farthestRadius * farthestRadius;
  double u = infinity;
  if (const auto fold = firstSignChange(slope, upper)) u = *fold;
  if (const auto pole = firstSignChange({denominator.begin(), denominator.end()}, upper)) u = std::min(u, *pole);
  return std::sqrt(u);
}

Distortion radialPart(const Distortion& d) {
  Distortion radial;
  radial.k = d.k;
  radial.q = d.q;
  radial.fisheye = d.fisheye;
  return radial;
}

Distortion flatPart(Distortion d) {
  d.tauX = d.tauY = d.imageSkew = 0;
  return d;
}

bool hasOnlyRadialTerms(const Distortion& d) {
  if (d.fisheye) return true;
  bool other = d.p1 != 0 || d.p2 != 0 || d.shear != 0 || d.skew != 0 || d.tauX != 0 || d.tauY != 0 || d.imageSkew != 0;
  for (const double c : d.s) other = other || c != 0;
  return !other;
}

/// Golden section for a minimum of f in (low, high).
template <class F>
double lowestBetween(const F& f, double low, double high) {
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double fa = f(a), fb = f(b);
  for (int i = 0; i < 24; ++i) {
    if (fa < fb) {
      high = b, b = a, fb = fa;
      a = high - golden * (high - low), fa = f(a);
    } else {
      low = a, a = b, fa = fb;
      b = low + golden * (high - low), fb = f(b);
    }
  }
  return fa < fb ? a : b;
}

}  // namespace

std::optional<double> firstSignChange(const std::vector<double>& coefficients, double upper) {
  const std::vector<double> all = signChanges(coefficients, upper);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

LensDomain::LensDomain(const Distortion& distortion)
    : m_lens(distortion), m_flat(flatPart(distortion)), m_radial(radialPart(distortion)),
      m_radialLimit(radialLimitOf(distortion)), m_foldBackRadius(m_radialLimit),
      m_bent(!hasOnlyRadialTerms(distortion)) {
  if (!m_bent) return;
  m_rayLimits.resize(rayCount);
  for (int i = 0; i < rayCount; ++i) m_rayLimits[i] = limitAlong(2 * std::numbers::pi * i / rayCount);
  const auto [least, most] = std::minmax_element(m_rayLimits.begin(), m_rayLimits.end());
  m_foldBackRadius = *most;
  m_surelyInside = 0.9 * *least;
}

double LensDomain::orientation(double x, double y) const {
  // Behind the tilt's vanishing line the point is seen upside down, whatever the determinant says.
  const DistortedPoint flat = jacobianOf(m_flat, {x, y});
  if (m_lens.tilted) {
    const auto& m = m_lens.tilt;
    if (!(m[6] * flat.position.x + m[7] * flat.position.y + m[8] > 0)) return -1;
  }
  return flat.determinant();
}

double LensDomain::limitAlong(double angleRad) const {
  if (!m_bent) return m_radialLimit;
  const double c = std::cos(angleRad), s = std::sin(angleRad);
  const auto at = [&](double r) { return orientation(r * c, r * s); };
  const double last = std::atan(std::min(m_radialLimit, farthestRadius));
  // Just inside the radial limit, where a pole would give no number.
  const auto sample = [&](int i) {
    return i < samplesPerRay ? std::tan(last * i / samplesPerRay) : std::tan(last) * (1 - 1e-9);
  };
  const auto border = [&](double good, double bad) {
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (good + bad);
      (at(middle) > 0 ? good : bad) = middle;
    }
    return good;
  };
  double before = 0, valueBefore = at(0);
  if (!(valueBefore > 0)) return 0;
  double r = sample(1), value = at(r);
  for (int i = 1; i <= samplesPerRay; ++i) {
    if (!(value > 0)) return border(before, r);
    const double next = i < samplesPerRay ? sample(i + 1) : r;
    const double valueNext = i < samplesPerRay ? at(next) : value;
    // A dip between samples may reach below zero and come back.
    if (value <= valueBefore && value < valueNext)
      if (const double dip = lowestBetween(at, before, next); !(at(dip) > 0)) return border(before, dip);
    before = r, valueBefore = value;
    r = next, value = valueNext;
  }
  return m_radialLimit;
}

bool LensDomain::contains(double x, double y) const {
  const double r2 = x * x + y * y;
  if (!(r2 <= m_foldBackRadius * m_foldBackRadius) || !std::isfinite(r2)) return false;
  if (r2 < m_surelyInside * m_surelyInside || !m_bent) return true;
  const double r = std::sqrt(r2);
  const double turn = std::atan2(y, x) / (2 * std::numbers::pi);
  const int bin = static_cast<int>(std::floor((turn - std::floor(turn)) * rayCount));
  double low = infinity, high = 0;
  for (int i = bin - 1; i <= bin + 2; ++i) {
    const double limit = m_rayLimits[(i + rayCount) % rayCount];
    low = std::min(low, limit);
    high = std::max(high, limit);
  }
  if (r < 0.9 * low) return true;
  if (r > 1.1 * high) return false;
  // Near a smooth border the determinant itself is exact; where the border jumps, beyond it the
  // determinant could be positive again.
  if (high < 1.2 * low) return orientation(x, y) > 0;
  return r <= limitAlong(std::atan2(y, x));
}

glm::dvec2 LensDomain::distorted(double x, double y) const {
  glm::dvec2 to;
  distort(m_lens, x, y, to.x, to.y);
  return to;
}

DistortedPoint LensDomain::distortedWithJacobian(double x, double y) const {
  return jacobianOf(m_lens, {x, y});
}

DistortedPoint LensDomain::jacobianOf(const Lens<double>& lens, const glm::dvec2& p) {
  Dual2 xd, yd;
  distort(lens, Dual2{p.x, 1, 0}, Dual2{p.y, 0, 1}, xd, yd);
  return {{xd.value, yd.value}, {xd.dx, yd.dx}, {xd.dy, yd.dy}};
}

}  // namespace alidade
