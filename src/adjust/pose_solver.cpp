// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/pose_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "adjust/robust.h"

namespace alidade {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largestScale = 20;

double medianSigmas(const PoseProblem& problem, const PoseState& state, const std::vector<int>& usable, int rank) {
  std::vector<double> all;
  for (const int i : usable) all.push_back(problem.sigmas(state, i));
  std::nth_element(all.begin(), all.begin() + rank, all.end());
  return all[rank];
}

std::vector<int> within(const PoseProblem& problem, const PoseState& state, const std::vector<int>& usable,
                        double limit) {
  std::vector<int> near;
  for (const int i : usable)
    if (problem.sigmas(state, i) <= limit) near.push_back(i);
  return near;
}

/// Stops adding where the sum has reached `enough`.
double truncatedCost(const PoseProblem& problem, const PoseState& state, const std::vector<int>& usable, double limit,
                     double enough = infinity) {
  double sum = 0;
  for (const int i : usable) {
    if (sum >= enough) break;
    const double s = std::min(limit, problem.sigmas(state, i));
    sum += s * s;
  }
  return sum;
}

/// Least squares on what agrees, until the same observations agree again.
PoseState settled(const PoseProblem& problem, PoseState state, const std::vector<int>& usable, double limit) {
  std::vector<int> before;
  for (int i = 0; i < 15; ++i) {
    std::vector<int> near = within(problem, state, usable, limit);
    if (static_cast<int>(near.size()) < problem.pointsNeeded() || near == before) break;
    state = problem.descend(state, near, 25);
    before = std::move(near);
  }
  return state;
}

struct Hypothesis {
  PoseState state;
  double score = infinity;
};

/// Poses through random small subsets, each from the start and from the Huber solution in turn.
std::vector<Hypothesis> subsetHypotheses(const PoseProblem& problem, const std::vector<int>& usable,
                                         const PoseState& robust, double limit) {
  constexpr int trials = 600, kept = 12;
  const int size = problem.pointsNeeded();
  std::vector<Hypothesis> best;
  if (static_cast<int>(usable.size()) <= size) return best;
  std::mt19937 random(20260611);
  std::vector<int> deck = usable;
  for (int trial = 0; trial < trials; ++trial) {
    for (int i = 0; i < size; ++i) {
      // Not std::uniform_int_distribution: its numbers differ between standard libraries.
      const std::size_t other = i + random() % (deck.size() - i);
      std::swap(deck[i], deck[other]);
    }
    const std::vector<int> subset(deck.begin(), deck.begin() + size);
    Hypothesis made;
    made.state = problem.descend(trial % 2 ? robust : problem.startState(), subset, 20);
    const double worst = static_cast<int>(best.size()) < kept ? infinity : best.back().score;
    made.score = truncatedCost(problem, made.state, usable, limit, worst);
    if (made.score >= worst) continue;
    best.push_back(made);
    std::sort(best.begin(), best.end(), [](const auto& a, const auto& b) { return a.score < b.score; });
    if (static_cast<int>(best.size()) > kept) best.pop_back();
  }
  return best;
}

/// Scale by the least median of squares: of two normal residuals, |r|/sigma has the median 1.1774.
double robustScale(const PoseProblem& problem, const PoseState& state, const std::vector<int>& usable) {
  const int n = static_cast<int>(usable.size()), size = problem.pointsNeeded();
  const int rank = std::min(n - 1, std::max((n + size + 1) / 2, size + 1) - 1);
  const double smallSample = 1 + 5.0 / std::max(1, n - size);
  return smallSample * medianSigmas(problem, state, usable, rank) / 1.1774;
}

/// Negative logarithm of the likelihood, up to a constant: picks within the limit are normal with the given sigmas times
/// `scale`, the others lie anywhere in the picture.
double surprise(const PoseProblem& problem, const PoseState& state, const std::vector<int>& usable, double limit, double scale) {
  const double picture = static_cast<double>(problem.camera().width()) * problem.camera().height();
  double sum = 0;
  for (const int i : usable) {
    const double s = problem.sigmas(state, i) / scale;
    // The density of a normal pick: the root of its weight's determinant over 2 pi scale².
    const double density = std::sqrt(glm::determinant(problem.weight(i))) / (2 * std::numbers::pi * scale * scale);
    sum += s <= limit ? 0.5 * s * s - std::log(density) : std::log(picture);
  }
  return sum;
}

}  // namespace

PoseSolution solvePose(const PoseProblem& problem, const PoseState& start, const std::vector<int>& chosen,
                       double huberSigmas, int maximumIterations) {
  PoseSolution solution;
  solution.state = problem.descend(start, chosen, maximumIterations, huberSigmas, &solution.iterations);
  // The honest question: how far, in standard deviations, is the next step?
  solution.converged = huberSigmas > 0 || problem.decrement(solution.state, chosen) < 1e-4;
  return solution;
}

Consensus findConsensus(const PoseProblem& problem, const std::vector<int>& usable, const ResectionOptions& options) {
  Consensus found;
  found.state = problem.startState();
  found.inliers = usable;
  const int n = static_cast<int>(usable.size());
  // Far from the solution every residual is an outlier: the loss narrows as the pose improves.
  const double first = std::max(options.huberSigmas, medianSigmas(problem, found.state, usable, n / 2));
  const auto solveWith = [&](double width) {
    const PoseSolution solution = solvePose(problem, found.state, usable, width, options.maximumIterations);
    found.state = solution.state;
    found.iterations += solution.iterations;
  };
  if (options.huberSigmas > 0 && first > 2 * options.huberSigmas) solveWith(first);
  solveWith(options.huberSigmas);
  if (options.huberSigmas <= 0) return found;
  const double limit = options.outlierSigmas;
  // Of many, a few right ones lie beyond the limit by chance: they are no sign that the pose is wrong.
  std::vector<int> near = within(problem, found.state, usable, n < 50 ? limit : std::max(limit, chanceLimit(usable.size())));
  if (static_cast<int>(near.size()) == n) return found;
  if (n >= 50 && 10 * static_cast<int>(near.size()) >= 9 * n) {
    found.inliers = std::move(near);
    return found;
  }

  std::vector<Hypothesis> all = subsetHypotheses(problem, usable, found.state, 3 * limit);
  all.push_back({found.state, infinity});
  Hypothesis best, median;
  double leastScale = infinity;
  for (const Hypothesis& rough : all) {
    // A pose through few noisy points leaves the others farther off than their own noise.
    Hypothesis refined{settled(problem, settled(problem, rough.state, usable, 3 * limit), usable, limit), 0};
    refined.score = truncatedCost(problem, refined.state, usable, limit);
    if (refined.score < best.score) best = refined;
    if (const double scale = robustScale(problem, rough.state, usable); scale < leastScale)
      leastScale = scale, median = rough;
  }
  found.state = best.state;
  found.inliers = within(problem, best.state, usable, limit);
  if (!std::isfinite(leastScale)) return found;

  const double scale = std::clamp(leastScale, 1.0, largestScale);
  const PoseState wide = settled(problem, median.state, usable, limit * scale);
  std::vector<int> agreeing = within(problem, wide, usable, limit * scale);
  if (2 * static_cast<int>(agreeing.size()) < n) return found;
  // A half of right picks misses one or two beyond the limit by chance; but where sigmas are too small, few picks may
  // agree with a pose by chance as well.
  const bool manyAgree = 7 * static_cast<int>(found.inliers.size()) >= 3 * n;
  if (manyAgree && surprise(problem, found.state, usable, limit, 1) <= surprise(problem, wide, usable, limit, scale)) return found;
  found.state = wide;
  found.inliers = std::move(agreeing);
  found.scale = scale;
  return found;
}

}  // namespace alidade
