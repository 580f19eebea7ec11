// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>

namespace alidade {

/// Continuous levels of detail after Zhang (2020), from van Oosterom (2019). `dimensions` is the n
/// of the formulas, `deepest` the L; a level lies in [0, L+1].
struct LevelLaw {
  int dimensions = 3;
  int deepest = 1;

  /// L = floor(log2(N / 8000) / n) + 1, at least 0.
  static LevelLaw forPointCount(std::uint64_t pointCount, int dimensions = 3);

  /// l = log2((2^((n-1)(L+1)) - 1) U + 1) / (n - 1), U uniform in [0,1).
  double levelOfUniform(double u) const;

  /// F(l) = (2^((n-1)l) - 1) / (2^((n-1)(L+1)) - 1): the share of all points with a level below l.
  double shareBelow(double level) const;

  /// The inverse of shareBelow: the level under which this share of the points lies.
  double levelOfShare(double share) const { return levelOfUniform(share); }
};

}  // namespace alidade
