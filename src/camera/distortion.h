// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>

namespace alidade {

/// Every lens that Alidade knows, as one set of coefficients. A coefficient that a model lacks is 0.
///
/// With x = X/Z, y = Y/Z, r² = x² + y²:
///
///     radial = (1 + k1 r² + … + k6 r¹²) / (1 + q1 r² + q2 r⁴ + q3 r⁶)
///     s      = 1 + t3 r² + t4 r⁴ + t5 r⁶ + t6 r⁸
///     x'' = x radial + (2 p1 x y + p2 (r² + 2x²)) s + s1 r² + s2 r⁴ + shear x + skew y
///     y'' = y radial + (p1 (r² + 2y²) + 2 p2 x y) s + s3 r² + s4 r⁴
///
/// followed by the sensor's tilt (tauX, tauY; OpenCV's 14-coefficient model) where there is one, and
/// last by x'' += imageSkew y'': pixel axes that are not square to each other (Metashape's b2 over fx).
/// k1..k3, q1..q3, p1, p2, s1..s4, tauX, tauY are OpenCV's k1..k3, k4..k6, p1, p2, s1..s4, tau
/// (OpenCV 4.6, calib3d); k4..k6 of the numerator, t3..t6, shear and skew are the high-order Brown
/// form of Gantner (2018), with the printed brackets mended.
///
/// A fisheye lens (OpenCV's `cv::fisheye`, Kannala and Brandt 2006) is instead
/// theta = atan(r), theta_d = theta (1 + k1 theta² + k2 theta⁴ + k3 theta⁶ + k4 theta⁸),
/// (x'', y'') = (x, y) theta_d / r; it uses k[0..3] alone.
template <class P>
struct BasicDistortion {
  std::array<P, 6> k{};  ///< radial numerator
  std::array<P, 3> q{};  ///< radial denominator
  P p1{}, p2{};          ///< decentring
  std::array<P, 4> t{};  ///< t3..t6, radial growth of the decentring
  std::array<P, 4> s{};  ///< thin prism
  P shear{}, skew{};
  P tauX{}, tauY{};      ///< sensor tilt, radians
  P imageSkew{};         ///< of the finished image coordinates
  bool fisheye = false;

  template <class Q>
  BasicDistortion<Q> cast() const;
};

using Distortion = BasicDistortion<double>;

}  // namespace alidade
