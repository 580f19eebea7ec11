// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/robust.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace alidade {

double chanceLimit(std::size_t n) {
  return std::sqrt(2 * std::log(1e5 * static_cast<double>(std::max<std::size_t>(n, 1))));
}

double widening95(double redundancy) {
  const double r = std::max(1.0, redundancy);
  return std::sqrt(0.5 * r * (std::pow(0.05, -2 / r) - 1) / -std::log(0.05));
}

std::string reasonOfConvergence(bool farAboveSigmas, double sigma0) {
  if (!farAboveSigmas) return "Converged";
  std::string reason = fmt::format("Converged, but the residuals are about {:.1f} times the given sigmas", sigma0);
  if (sigma0 > 1) reason += "; all standard deviations are multiplied by that";
  return reason;
}

Result<void> checkRobustOptions(double huberSigmas, double outlierSigmas, int maximumIterations) {
  if (!std::isfinite(huberSigmas) || huberSigmas < 0)
    return fail("The robust loss's width must be zero or positive", "huberSigmas", "Give 2.5, or 0 for none");
  if (!std::isfinite(outlierSigmas) || !(outlierSigmas > 0))
    return fail("The limit for outliers must be positive", "outlierSigmas", "Give 3.5");
  if (maximumIterations < 1 || maximumIterations > 100000)
    return fail("The number of iterations must lie between 1 and 100000", "maximumIterations", "Give 100");
  return {};
}

}  // namespace alidade
