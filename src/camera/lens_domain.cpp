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

bool hasOnlyRadialTerms(const Distortion& d) {
  if (d.fisheye) return true;
  bool other = d.p1 != 0 || d.p2 != 0 || d.shear != 0 || d.skew != 0 || d.tauX != 0 || d.tauY != 0;
  for (const double c : d.s) other = other || c != 0;
  return !other;
}

}  // namespace

std::optional<double> firstSignChange(const std::vector<double>& coefficients, double upper) {
  const std::vector<double> all = signChanges(coefficients, upper);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

LensDomain::LensDomain(const Distortion& distortion)
    : m_lens(distortion), m_radial(radialPart(distortion)), m_radialLimit(radialLimitOf(distortion)),
      m_foldBackRadius(m_radialLimit) {
  if (hasOnlyRadialTerms(distortion)) return;
  std::vector<double> limits(rayCount);
  for (int i = 0; i < rayCount; ++i) limits[i] = limitAlong(2 * std::numbers::pi * i / rayCount);
  m_rayLimits = std::move(limits);
  m_foldBackRadius = *std::max_element(m_rayLimits.begin(), m_rayLimits.end());
}

double LensDomain::limitAlong(double angleRad) const {
  if (purelyRadial() && hasOnlyRadialTerms(m_lens.d)) return m_radialLimit;
  const double c = std::cos(angleRad), s = std::sin(angleRad);
  const auto good = [&](double r) { return distortedWithJacobian(r * c, r * s).determinant() > 0; };
  const double last = std::atan(std::min(m_radialLimit, farthestRadius));
  double low = 0;
  for (int i = 0; i <= samplesPerRay; ++i) {
    // Just inside the radial limit, where a pole would give no number.
    const double r = i < samplesPerRay ? std::tan(last * i / samplesPerRay) : std::tan(last) * (1 - 1e-9);
    if (good(r)) {
      low = r;
      continue;
    }
    double high = r;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (good(middle) ? low : high) = middle;
    }
    return low;
  }
  return m_radialLimit;
}

bool LensDomain::contains(double x, double y) const {
  const double r2 = x * x + y * y;
  if (!(r2 <= m_foldBackRadius * m_foldBackRadius) || !std::isfinite(r2)) return false;
  if (purelyRadial()) return true;
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
  // Near the border the determinant itself is exact; far beyond it could be positive again.
  return distortedWithJacobian(x, y).determinant() > 0;
}

glm::dvec2 LensDomain::distorted(double x, double y) const {
  glm::dvec2 to;
  distort(m_lens, x, y, to.x, to.y);
  return to;
}

DistortedPoint LensDomain::distortedWithJacobian(double x, double y) const {
  Dual2 xd, yd;
  distort(m_lens, Dual2{x, 1, 0}, Dual2{y, 0, 1}, xd, yd);
  return {{xd.value, yd.value}, {xd.dx, yd.dx}, {xd.dy, yd.dy}};
}

}  // namespace alidade
