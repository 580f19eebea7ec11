// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/pose_solver.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <random>

#include <ceres/ceres.h>

#include "adjust/reprojection_cost.h"

namespace alidade {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double largestScale = 20;

void lockBlocks(const PoseProblem& problem, ceres::Problem& solver, double* centre, double* rotation) {
  std::vector<int> locked;
  for (int i = 0; i < 3; ++i)
    if (std::find(problem.freeColumns().begin(), problem.freeColumns().end(), i) == problem.freeColumns().end())
      locked.push_back(i);
  if (locked.size() == 3)
    solver.SetParameterBlockConstant(centre);
  else if (!locked.empty())
    solver.SetManifold(centre, new ceres::SubsetManifold(3, locked));
  if (problem.attitudeFree())
    solver.SetManifold(rotation, new ceres::QuaternionManifold);
  else
    solver.SetParameterBlockConstant(rotation);
}

PoseSolution solveUnguarded(const PoseProblem& problem, const PoseState& start, const std::vector<int>& chosen,
                            double huberSigmas, int maximumIterations) {
  double centre[3] = {start.centre.x, start.centre.y, start.centre.z};
  double rotation[4] = {start.rotation.w, start.rotation.x, start.rotation.y, start.rotation.z};
  ceres::Problem solver;
  for (const int i : chosen) {
    const ResectionObservation& seen = problem.observations()[i];
    auto* cost = new ReprojectionCost{&problem.camera(), seen.pixel, seen.world - problem.origin(), seen.sigmaPx};
    solver.AddResidualBlock(new ceres::AutoDiffCostFunction<ReprojectionCost, 2, 3, 4>(cost),
                            huberSigmas > 0 ? new ceres::HuberLoss(huberSigmas) : nullptr, centre, rotation);
  }
  lockBlocks(problem, solver, centre, rotation);

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = maximumIterations;
  // Tighter, and rounding makes the last steps look invalid.
  options.function_tolerance = 1e-11;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-11;
  options.max_num_consecutive_invalid_steps = 20;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &solver, &summary);

  PoseSolution solution;
  solution.state.centre = {centre[0], centre[1], centre[2]};
  solution.state.rotation = glm::normalize(glm::dquat(rotation[0], rotation[1], rotation[2], rotation[3]));
  solution.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps;
  solution.message = summary.message;
  if (huberSigmas > 0) {
    solution.converged = summary.termination_type == ceres::CONVERGENCE;
  } else if (summary.termination_type != ceres::FAILURE) {
    // Newton's last digits, then the honest question: how far, in standard deviations, is the next step?
    solution.state = problem.descend(solution.state, chosen, 4);
    solution.converged = summary.termination_type == ceres::CONVERGENCE && problem.decrement(solution.state, chosen) < 1e-4;
  }
  return solution;
}

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

double truncatedCost(const PoseProblem& problem, const PoseState& state, const std::vector<int>& usable, double limit) {
  double sum = 0;
  for (const int i : usable) {
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
    made.score = truncatedCost(problem, made.state, usable, limit);
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

}  // namespace

PoseSolution solvePose(const PoseProblem& problem, const PoseState& start, const std::vector<int>& chosen,
                       double huberSigmas, int maximumIterations) {
  try {
    return solveUnguarded(problem, start, chosen, huberSigmas, maximumIterations);
  } catch (const std::exception& error) {
    PoseSolution failed;
    failed.state = start;
    failed.message = error.what();
    return failed;
  }
}

Consensus findConsensus(const PoseProblem& problem, const std::vector<int>& usable, const ResectionOptions& options) {
  Consensus found;
  found.state = problem.startState();
  found.inliers = usable;
  const int n = static_cast<int>(usable.size());
  // Far from the solution every residual is an outlier: the loss narrows as the pose improves.
  const double first = std::max(options.huberSigmas, medianSigmas(problem, found.state, usable, n / 2));
  for (const double width : {first, options.huberSigmas}) {
    const PoseSolution solution =
        solvePose(problem, found.state, usable, options.huberSigmas > 0 ? width : 0, options.maximumIterations);
    found.state = solution.state;
    found.iterations += solution.iterations;
    if (options.huberSigmas <= 0) return found;
  }
  const double limit = options.outlierSigmas;
  if (static_cast<int>(within(problem, found.state, usable, limit).size()) == n) return found;

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
  if (2 * static_cast<int>(found.inliers.size()) >= n || !std::isfinite(leastScale)) return found;

  const double scale = std::clamp(leastScale, 1.0, largestScale);
  const PoseState wide = settled(problem, median.state, usable, limit * scale);
  std::vector<int> agreeing = within(problem, wide, usable, limit * scale);
  if (2 * static_cast<int>(agreeing.size()) < n) return found;
  found.state = wide;
  found.inliers = std::move(agreeing);
  found.scale = scale;
  return found;
}

}  // namespace alidade
