// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/network_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/parallel.h"

namespace alidade {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Damping that shortens no step worth mentioning.
constexpr double kLightDamping = 1e-8;
/// Half the squared length of a step in standard deviations: a hundredth of one is as good as standing still.
constexpr double kStill = 0.5 * 0.01 * 0.01;

}  // namespace

std::vector<double> termSigmas(const NetworkTerms& terms, const NetworkState& state) {
  const NetworkTerms::Prepared prepared = terms.prepare(state);
  std::vector<double> sigmas(terms.terms().size(), infinity);
  parallelFor(sigmas.size(), 1024, [&](std::size_t first, std::size_t last, int) {
    TermValue value;
    for (std::size_t t = first; t < last; ++t)
      if (terms.evaluate(state, prepared, terms.terms()[t], false, value)) {
        const double s = std::sqrt(value.squares());
        if (std::isfinite(s)) sigmas[t] = s;
      }
  });
  return sigmas;
}

double networkCost(const NetworkTerms& terms, const NetworkState& state, const std::vector<char>& active,
                   double huberSigmas) {
  const NetworkTerms::Prepared prepared = terms.prepare(state);
  const std::size_t count = terms.terms().size();
  // Summed chunk by chunk in order, so that a run repeats to the last digit.
  constexpr std::size_t grain = 1024;
  std::vector<double> sums(count / grain + 1, 0);
  parallelFor(count, grain, [&](std::size_t first, std::size_t last, int) {
    TermValue value;
    double sum = 0;
    for (std::size_t t = first; t < last; ++t) {
      if (!active[t]) continue;
      const Term& term = terms.terms()[t];
      const bool valued = terms.evaluate(state, prepared, term, false, value);
      const double squares = valued ? value.squares() : infinity;
      const double s = huberSigmas > 0 && term.robust ? std::sqrt(squares) : 0;
      sum += s > huberSigmas ? huberSigmas * (2 * s - huberSigmas) : squares;
    }
    sums[first / grain] += sum;
  });
  double cost = 0;
  for (const double sum : sums) cost += 0.5 * sum;
  return std::isfinite(cost) ? cost : infinity;
}

NetworkFit fitNetwork(const NetworkTerms& terms, NormalSystem& normals, const std::vector<char>& active,
                      NetworkState start, double huberSigmas, int maximumIterations, const Progress& progress) {
  NetworkFit fit;
  fit.state = std::move(start);
  fit.initialCost = fit.cost = networkCost(terms, fit.state, active, huberSigmas);
  if (!std::isfinite(fit.cost)) return fit;
  double damping = 1e-4, growth = 2;
  bool fresh = false, doubted = false;
  while (fit.iterations < maximumIterations) {
    if (progress.cancelled()) {
      fit.cancelled = true;
      return fit;
    }
    if (!fresh && !normals.linearise(fit.state, huberSigmas)) return fit;
    fresh = true;
    ++fit.iterations;
    progress.report(static_cast<double>(fit.iterations) / maximumIterations,
                    fmt::format("Adjusting, iteration {}", fit.iterations));
    double gain = -1, promised = 0;
    if (normals.solve(damping)) {
      promised = normals.promisedDecrease();
      const bool undamped = damping <= kLightDamping;
      const bool last = promised <= 1e-9 * fit.cost + 1e-12 || (doubted && undamped && promised <= kStill);
      NetworkState next = terms.layout().moved(fit.state, normals.blockStep().data(), normals.pointStep());
      const double cost = networkCost(terms, next, active, huberSigmas);
      if (promised > 0) gain = (fit.cost - cost) / promised;
      if (cost <= fit.cost) fit.state = std::move(next), fit.cost = cost, fresh = false;
      if (last) {
        // A step that is damped enough promises little anywhere: only the undamped one tells that this is a minimum.
        if (undamped || doubted) {
          fit.converged = undamped;
          return fit;
        }
        doubted = true;
        damping = kLightDamping, growth = 2;
        continue;
      }
    } else if (doubted && damping <= kLightDamping) {
      // Something is left open, as in a free network; what is not open stands at its minimum.
      fit.converged = true;
      return fit;
    }
    if (gain > 1e-4) {
      doubted = false;
      const double good = 2 * gain - 1;
      damping = std::max(1e-14, damping * std::max(0.03, 1 - good * good * good));
      growth = 2;
    } else {
      damping *= growth;
      growth *= 2;
      if (damping > 1e12) return fit;
    }
  }
  return fit;
}

}  // namespace alidade
