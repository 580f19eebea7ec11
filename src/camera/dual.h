// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cmath>

namespace alidade {

/// A number with its derivatives by two variables: forward-mode differentiation of the lens.
struct Dual2 {
  double value = 0;
  double dx = 0, dy = 0;
};

inline Dual2 operator+(const Dual2& a, const Dual2& b) { return {a.value + b.value, a.dx + b.dx, a.dy + b.dy}; }
inline Dual2 operator-(const Dual2& a, const Dual2& b) { return {a.value - b.value, a.dx - b.dx, a.dy - b.dy}; }
inline Dual2 operator*(const Dual2& a, const Dual2& b) {
  return {a.value * b.value, a.dx * b.value + a.value * b.dx, a.dy * b.value + a.value * b.dy};
}
inline Dual2 operator/(const Dual2& a, const Dual2& b) {
  const double inverse = 1.0 / b.value, ratio = a.value / b.value;
  return {ratio, (a.dx - ratio * b.dx) * inverse, (a.dy - ratio * b.dy) * inverse};
}
inline Dual2 operator+(double a, const Dual2& b) { return {a + b.value, b.dx, b.dy}; }
inline Dual2 operator+(const Dual2& a, double b) { return b + a; }
inline Dual2 operator-(const Dual2& a, double b) { return {a.value - b, a.dx, a.dy}; }
inline Dual2 operator*(double a, const Dual2& b) { return {a * b.value, a * b.dx, a * b.dy}; }
inline Dual2 operator*(const Dual2& a, double b) { return b * a; }
inline Dual2 operator/(double a, const Dual2& b) { return Dual2{a} / b; }
inline bool operator<(const Dual2& a, double b) { return a.value < b; }

inline Dual2 sqrt(const Dual2& a) {
  const double root = std::sqrt(a.value), slope = 0.5 / root;
  return {root, slope * a.dx, slope * a.dy};
}
inline Dual2 atan(const Dual2& a) {
  const double slope = 1.0 / (1.0 + a.value * a.value);
  return {std::atan(a.value), slope * a.dx, slope * a.dy};
}

}  // namespace alidade
