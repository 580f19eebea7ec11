// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace alidade {

/// square (n × m, row by row) -= yᵀ w, with y three rows of n and w three rows of m.
inline void subtractOuterAny(const double* y, int n, const double* w, int m, double* square) {
  for (int i = 0; i < n; ++i) {
    const double a = y[i], b = y[n + i], c = y[2 * n + i];
    for (int j = 0; j < m; ++j) square[i * m + j] -= a * w[j] + b * w[m + j] + c * w[2 * m + j];
  }
}

/// The same with the sizes known: a pose against a pose is nearly all of the work.
template <int n, int m>
inline void subtractOuterFixed(const double* y, const double* w, double* square) {
  for (int i = 0; i < n; ++i) {
    const double a = y[i], b = y[n + i], c = y[2 * n + i];
    for (int j = 0; j < m; ++j) square[i * m + j] -= a * w[j] + b * w[m + j] + c * w[2 * m + j];
  }
}

inline void subtractOuter(const double* y, int n, const double* w, int m, double* square) {
  if (n == 6 && m == 6)
    subtractOuterFixed<6, 6>(y, w, square);
  else
    subtractOuterAny(y, n, w, m, square);
}

}  // namespace alidade
