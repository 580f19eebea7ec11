// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "cloud/levels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace alidade {

namespace {

/// (n-1)(L+1) ln 2: the exponent of the law. 0 for one dimension, where the law becomes uniform.
double exponent(const LevelLaw& law) {
  return (law.dimensions - 1) * (law.deepest + 1) * std::numbers::ln2;
}

}  // namespace

LevelLaw LevelLaw::forPointCount(std::uint64_t pointCount, int dimensions) {
  LevelLaw law;
  law.dimensions = std::max(1, dimensions);
  law.deepest = 0;
  if (pointCount > 0) {
    const double depth = std::log2(static_cast<double>(pointCount) / 8000.0) / law.dimensions;
    law.deepest = std::max(0, static_cast<int>(std::floor(depth)) + 1);
  }
  return law;
}

double LevelLaw::levelOfUniform(double u) const {
  u = std::clamp(u, 0.0, 1.0);
  const double a = exponent(*this);
  if (a == 0.0) return u * (deepest + 1);
  return std::log1p(std::expm1(a) * u) / ((dimensions - 1) * std::numbers::ln2);
}

double LevelLaw::shareBelow(double level) const {
  level = std::clamp(level, 0.0, static_cast<double>(deepest + 1));
  const double a = exponent(*this);
  if (a == 0.0) return level / (deepest + 1);
  return std::expm1((dimensions - 1) * level * std::numbers::ln2) / std::expm1(a);
}

}  // namespace alidade
