// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "camera/distortion.h"

/// The one definition of the lens. Everything that bends a ray goes through `distort` below: the
/// scalar camera, the dual numbers of its Jacobian, the solver's automatic derivatives and the
/// vector types of the point splatter; resources/shaders/distortion.glsl is its twin, held to it by
/// a test.
///
/// T is the type of a coordinate: double, float, an automatic-derivative type (ceres::Jet, Dual2)
/// or a GCC vector of floats such as `float __attribute__((vector_size(64)))`. P is the type of a
/// coefficient: double, float, or the same automatic-derivative type as T. For vectors P is the
/// lane's type.
///
/// All functions are always inlined: a translation unit compiled for AVX-512 must never leave behind
/// a shared copy that the linker could choose for the others.
#define ALIDADE_LENS_INLINE [[gnu::always_inline]] inline

namespace alidade {

/// What of the lens has to be computed; chosen once per camera, so that loops pay only for it.
enum class LensKind {
  None,     ///< no distortion
  Radial,   ///< k1..k3
  Brown,    ///< k1..k3, p1, p2: OpenCV's five coefficients
  Full,     ///< everything but the fisheye
  Fisheye,  ///< k1..k4 of theta
};

/// The cheapest kind that computes this lens exactly.
template <class P>
ALIDADE_LENS_INLINE LensKind kindOf(const BasicDistortion<P>& d) {
  if (d.fisheye) return LensKind::Fisheye;
  const P zero(0);
  bool full = d.k[3] != zero || d.k[4] != zero || d.k[5] != zero || d.shear != zero || d.skew != zero ||
              d.tauX != zero || d.tauY != zero || d.imageSkew != zero;
  for (const P& c : d.q) full = full || c != zero;
  for (const P& c : d.s) full = full || c != zero;
  const bool decentred = d.p1 != zero || d.p2 != zero;
  for (const P& c : d.t) full = full || (decentred && c != zero);
  if (full) return LensKind::Full;
  if (decentred) return LensKind::Brown;
  const bool radial = d.k[0] != zero || d.k[1] != zero || d.k[2] != zero;
  return radial ? LensKind::Radial : LensKind::None;
}

/// Coefficients with what is derived from them once: the kind, and the sensor's tilt and skew as a matrix.
template <class P>
struct Lens {
  BasicDistortion<P> d;
  LensKind kind = LensKind::None;
  bool tilted = false;
  std::array<P, 9> tilt{};  ///< row by row: homogeneous (x'', y'', 1) on the tilted sensor

  Lens() = default;

  /// `parametersVary`: the coefficients are unknowns of a solver, so that a zero prunes nothing.
  [[gnu::always_inline]] explicit Lens(const BasicDistortion<P>& distortion, bool parametersVary = false)
      : d(distortion), kind(parametersVary ? varying(distortion) : kindOf(distortion)) {
    tilted = !d.fisheye && (parametersVary || d.tauX != P(0) || d.tauY != P(0) || d.imageSkew != P(0));
    if (tilted) setTilt();
  }

 private:
  [[gnu::always_inline]] static LensKind varying(const BasicDistortion<P>& distortion) {
    return distortion.fisheye ? LensKind::Fisheye : LensKind::Full;
  }

  /// OpenCV 4.6, calib3d, computeTiltProjectionMatrix: turn about x by tauX, then about y by tauY, then
  /// back along z onto the sensor's plane. The skew of the image comes last.
  [[gnu::always_inline]] void setTilt() {
    using std::cos;
    using std::sin;
    const P cx = cos(d.tauX), sx = sin(d.tauX), cy = cos(d.tauY), sy = sin(d.tauY);
    const std::array<P, 9> r{cy, sy * sx, -sy * cx, P(0), cx, sx, sy, -cy * sx, cy * cx};
    for (int i = 0; i < 3; ++i) {
      tilt[i] = r[8] * r[i] - r[2] * r[6 + i];
      tilt[3 + i] = r[8] * r[3 + i] - r[5] * r[6 + i];
      tilt[6 + i] = r[6 + i];
    }
    for (int i = 0; i < 3; ++i) tilt[i] = tilt[i] + d.imageSkew * tilt[3 + i];
  }
};

namespace lens_detail {

template <class T>
concept SimdVector = !std::is_class_v<T> && !std::is_arithmetic_v<T> && !std::is_pointer_v<T> &&
                     requires(T v) { v[0]; v + v; };

/// sqrt(v) for v >= 0: reciprocal root from the exponent, three Newton steps (about one ulp of a
/// float), no branch, any vector width.
template <SimdVector T>
ALIDADE_LENS_INLINE T squareRoot(const T& v) {
  using Lane = std::remove_cvref_t<decltype(v[0])>;
  static_assert(sizeof(Lane) == 4, "vectors of float");
  using Bits = decltype(v < v);
  T y = reinterpret_cast<T>(0x5f3759df - (reinterpret_cast<Bits>(v) >> 1));
  const T half = v * Lane(0.5);
  for (int i = 0; i < 3; ++i) y = y * (Lane(1.5) - half * y * y);
  return v * y;
}

/// atan(r) for r >= 0 by Cephes' atanf reduction (Moshier): to |z| <= tan(pi/8), then degree 9.
template <SimdVector T>
ALIDADE_LENS_INLINE T arcTangent(const T& r) {
  using Lane = std::remove_cvref_t<decltype(r[0])>;
  static_assert(sizeof(Lane) == 4, "vectors of float");
  const T zero = r - r;
  const auto far = r > Lane(2.414213562373095);
  const auto middle = r > Lane(0.4142135623730950);
  const T z = far ? Lane(-1) / (far ? r : zero + Lane(1)) : (middle ? (r - Lane(1)) / (r + Lane(1)) : r);
  const T start = far ? zero + Lane(1.5707963267948966) : (middle ? zero + Lane(0.7853981633974483) : zero);
  const T z2 = z * z;
  const T poly = ((Lane(8.05374449538e-2) * z2 - Lane(1.38776856032e-1)) * z2 + Lane(1.99777106478e-1)) * z2 -
                 Lane(3.33329491539e-1);
  return start + (poly * z2 * z + z);
}

/// atan(r)/r as a series in r², for r² < 1e-4: the next term is below 1e-21.
template <class P, class T>
ALIDADE_LENS_INLINE T atanOverRadiusSeries(const T& r2) {
  return P(1) + r2 * (P(-1.0 / 3) + r2 * (P(1.0 / 5) + r2 * (P(-1.0 / 7) + r2 * P(1.0 / 9))));
}

/// atan(r)/r from r²; smooth through r = 0, where the square root has no derivative.
template <class P, class T>
ALIDADE_LENS_INLINE T atanOverRadius(const T& r2) {
  if constexpr (SimdVector<T>) {
    const T one = (r2 - r2) + P(1);
    const auto small = r2 < P(1e-4);
    const T r = squareRoot(T(small ? one : r2));
    return small ? atanOverRadiusSeries<P>(r2) : arcTangent(r) / r;
  } else {
    using std::atan;
    using std::sqrt;
    if (r2 < P(1e-4)) return atanOverRadiusSeries<P>(r2);
    const T r = sqrt(r2);
    return atan(r) / r;
  }
}

template <class P, class T>
ALIDADE_LENS_INLINE void distortFisheye(const BasicDistortion<P>& d, const T& x, const T& y, T& xd, T& yd) {
  const T r2 = x * x + y * y;
  const T ratio = atanOverRadius<P>(r2);
  const T theta2 = ratio * ratio * r2;
  const T scale = ratio * (P(1) + theta2 * (d.k[0] + theta2 * (d.k[1] + theta2 * (d.k[2] + theta2 * d.k[3]))));
  xd = x * scale;
  yd = y * scale;
}

template <class P, class T>
ALIDADE_LENS_INLINE void distortFull(const Lens<P>& lens, const T& x, const T& y, T& xd, T& yd) {
  const BasicDistortion<P>& d = lens.d;
  const T r2 = x * x + y * y;
  const T high = d.k[2] + r2 * (d.k[3] + r2 * (d.k[4] + r2 * d.k[5]));
  const T numerator = P(1) + r2 * (d.k[0] + r2 * (d.k[1] + r2 * high));
  const T denominator = P(1) + r2 * (d.q[0] + r2 * (d.q[1] + r2 * d.q[2]));
  const T radial = numerator / denominator;
  const T growth = P(1) + r2 * (d.t[0] + r2 * (d.t[1] + r2 * (d.t[2] + r2 * d.t[3])));
  const T xy2 = P(2) * (x * y);
  const T decentredX = d.p1 * xy2 + d.p2 * (r2 + P(2) * (x * x));
  const T decentredY = d.p1 * (r2 + P(2) * (y * y)) + d.p2 * xy2;
  xd = x * radial + decentredX * growth + r2 * (d.s[0] + r2 * d.s[1]) + (d.shear * x + d.skew * y);
  yd = y * radial + decentredY * growth + r2 * (d.s[2] + r2 * d.s[3]);
  if (lens.tilted) {
    const auto& m = lens.tilt;
    const T tx = m[0] * xd + m[1] * yd + m[2];
    const T ty = m[3] * xd + m[4] * yd + m[5];
    const T inverse = P(1) / (m[6] * xd + m[7] * yd + m[8]);
    xd = tx * inverse;
    yd = ty * inverse;
  }
}

}  // namespace lens_detail

/// (x, y) = (X/Z, Y/Z) -> (x'', y'') through the lens; the formulas stand in distortion.h. No domain
/// check: beyond the fold-back radius the model returns into the picture.
template <LensKind kind, class P, class T>
ALIDADE_LENS_INLINE void distort(const Lens<P>& lens, const T& x, const T& y, T& xd, T& yd) {
  const BasicDistortion<P>& d = lens.d;
  if constexpr (kind == LensKind::None) {
    xd = x;
    yd = y;
  } else if constexpr (kind == LensKind::Radial) {
    const T r2 = x * x + y * y;
    const T radial = P(1) + r2 * (d.k[0] + r2 * (d.k[1] + r2 * d.k[2]));
    xd = x * radial;
    yd = y * radial;
  } else if constexpr (kind == LensKind::Brown) {
    const T x2 = x * x, y2 = y * y;
    const T r2 = x2 + y2;
    const T radial = P(1) + r2 * (d.k[0] + r2 * (d.k[1] + r2 * d.k[2]));
    const T xy2 = P(2) * (x * y);
    xd = x * radial + (d.p1 * xy2 + d.p2 * (r2 + P(2) * x2));
    yd = y * radial + (d.p1 * (r2 + P(2) * y2) + d.p2 * xy2);
  } else if constexpr (kind == LensKind::Fisheye) {
    lens_detail::distortFisheye(d, x, y, xd, yd);
  } else {
    lens_detail::distortFull(lens, x, y, xd, yd);
  }
}

/// The same with the kind looked up at run time.
template <class P, class T>
ALIDADE_LENS_INLINE void distort(const Lens<P>& lens, const T& x, const T& y, T& xd, T& yd) {
  switch (lens.kind) {
    case LensKind::None: return distort<LensKind::None>(lens, x, y, xd, yd);
    case LensKind::Radial: return distort<LensKind::Radial>(lens, x, y, xd, yd);
    case LensKind::Brown: return distort<LensKind::Brown>(lens, x, y, xd, yd);
    case LensKind::Fisheye: return distort<LensKind::Fisheye>(lens, x, y, xd, yd);
    case LensKind::Full: break;
  }
  distort<LensKind::Full>(lens, x, y, xd, yd);
}

template <class P>
template <class Q>
BasicDistortion<Q> BasicDistortion<P>::cast() const {
  BasicDistortion<Q> to;
  const auto copy = [](const auto& from, auto& into) {
    for (std::size_t i = 0; i < from.size(); ++i) into[i] = Q(from[i]);
  };
  copy(k, to.k);
  copy(q, to.q);
  copy(t, to.t);
  copy(s, to.s);
  to.p1 = Q(p1), to.p2 = Q(p2);
  to.shear = Q(shear), to.skew = Q(skew);
  to.tauX = Q(tauX), to.tauY = Q(tauY);
  to.imageSkew = Q(imageSkew);
  to.fisheye = fisheye;
  return to;
}

}  // namespace alidade
