// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <limits>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "camera/dual.h"
#include "camera/lens_kernel.h"

namespace alidade {

/// Distorted position with its derivatives by the undistorted x and y.
struct DistortedPoint {
  glm::dvec2 position{0};
  glm::dvec2 dx{0};  ///< d(x'', y'')/dx
  glm::dvec2 dy{0};  ///< d(x'', y'')/dy

  double determinant() const { return dx.x * dy.y - dy.x * dx.y; }
};

/// A lens together with the part of the undistorted image plane where it maps one to one, and the
/// inverse there.
///
/// The radial factor alone bounds the domain by a circle: the first r > 0 where d(r radial)/dr
/// reaches 0, or where the denominator has a pole. Decentring, thin prism, shear and tilt move that
/// border: the domain is then star-shaped, along each ray from the axis up to the first point where
/// the determinant of the lens' Jacobian is no longer positive. The circle stays as its outer bound.
class LensDomain {
 public:
  LensDomain() = default;
  explicit LensDomain(const Distortion& distortion);

  const Lens<double>& lens() const { return m_lens; }

  /// Radius of the circle that holds the whole domain; infinite where nothing folds below r = 10⁴.
  double foldBackRadius() const { return m_foldBackRadius; }

  /// False for anything not finite.
  bool contains(double x, double y) const;

  /// How far the domain reaches along a ray, at most foldBackRadius().
  double limitAlong(double angleRad) const;

  glm::dvec2 distorted(double x, double y) const;
  DistortedPoint distortedWithJacobian(double x, double y) const;

  /// The point of the domain that the lens moves to `distorted`; nothing where there is none. The
  /// residual |distort(result) - distorted| is below 1e-12 (1 + |distorted|) before the sensor's tilt.
  std::optional<glm::dvec2> undistorted(const glm::dvec2& distorted) const;

 private:
  static DistortedPoint jacobianOf(const Lens<double>& lens, const glm::dvec2& p);
  double orientation(double x, double y) const;
  std::optional<double> inverseRadius(double distortedRadius) const;
  std::optional<glm::dvec2> withoutTilt(const glm::dvec2& distorted) const;
  glm::dvec2 startFor(const glm::dvec2& flat) const;
  std::optional<glm::dvec2> descend(glm::dvec2 p, const glm::dvec2& target) const;
  std::optional<glm::dvec2> continued(glm::dvec2 p, const glm::dvec2& target) const;

  Lens<double> m_lens;
  Lens<double> m_flat;              ///< without the sensor's tilt
  Lens<double> m_radial;            ///< the radial factor alone
  double m_radialLimit = std::numeric_limits<double>::infinity();
  double m_foldBackRadius = std::numeric_limits<double>::infinity();
  double m_surelyInside = 0;        ///< no direction ends below this radius
  bool m_bent = false;              ///< has more than a radial factor: the domain is no circle
  std::vector<double> m_rayLimits;  ///< of a bent lens, by equal steps of angle
};

/// The first u in (0, upper] where the polynomial changes sign; nothing where it does not.
/// `coefficients[i]` belongs to uⁱ. Roots are isolated by the derivative's roots, so that close
/// pairs are not missed.
std::optional<double> firstSignChange(const std::vector<double>& coefficients, double upper);

}  // namespace alidade
