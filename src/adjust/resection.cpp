// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/resection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "adjust/pose_problem.h"
#include "adjust/pose_solver.h"
#include "adjust/resection_checks.h"
#include "adjust/robust.h"

namespace alidade {

namespace {

constexpr double noNumber = std::numeric_limits<double>::quiet_NaN();

/// Residual of an observation in units of its own standard deviation: an adjusted residual has the
/// covariance s²I - J Q Jᵀ, that of an observation left out s²I + J Q Jᵀ (Baarda 1968). An observation
/// that nothing else checks keeps a tenth of its sigma, so that it cannot be condemned by rounding.
double standardised(const PoseProblem& problem, const PoseState& state, const Matrix6& covariance, int i, bool used) {
  const auto at = problem.linearise(state, i);
  if (!at) return std::numeric_limits<double>::infinity();
  const glm::dmat2 given = glm::inverse(problem.weight(i));
  const double variance = std::max(given[0][0], given[1][1]);
  const Eigen::Matrix2d byPose = at->jacobian * covariance * at->jacobian.transpose();
  Eigen::Matrix2d own;
  own << given[0][0], given[1][0], given[0][1], given[1][1];
  own += (used ? -1 : 1) * byPose;
  const double determinant = own(0, 0) * own(1, 1) - own(0, 1) * own(0, 1), trace = own(0, 0) + own(1, 1);
  const double smallest = 0.5 * (trace - std::sqrt(std::max(0.0, trace * trace - 4 * determinant)));
  if (smallest > 0.01 * variance) {
    const glm::dvec2& o = at->residualPx;
    return std::sqrt((own(1, 1) * o.x * o.x - 2 * own(0, 1) * o.x * o.y + own(0, 0) * o.y * o.y) / determinant);
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(own);
  const Eigen::Vector2d r = axes.eigenvectors().transpose() * Eigen::Vector2d(at->residualPx.x, at->residualPx.y);
  double sum = 0;
  for (int k = 0; k < 2; ++k) sum += r[k] * r[k] / std::max(axes.eigenvalues()[k], 0.01 * variance);
  return std::sqrt(sum);
}

struct Adjusted {
  PoseSolution solution;
  std::vector<int> inliers;
  std::optional<Matrix6> covariance;
  int iterations = 0;
};

/// Plain least squares on the inliers; then one observation at a time is dropped or taken back by
/// its standardised residual, until none changes side.
Adjusted adjust(const PoseProblem& problem, PoseState state, std::vector<int> inliers, const std::vector<int>& usable,
                double limit, const ResectionOptions& options) {
  Adjusted done;
  const bool robust = options.huberSigmas > 0;
  for (int round = 0; round < 2 * problem.size() + 5; ++round) {
    done.solution = solvePose(problem, state, inliers, 0, options.maximumIterations);
    done.iterations += done.solution.iterations;
    state = done.solution.state;
    done.covariance = problem.covariance(problem.normalMatrix(state, inliers));
    if (!done.covariance || !robust) break;
    const auto used = [&](int i) { return std::binary_search(inliers.begin(), inliers.end(), i); };
    int worst = -1, best = -1;
    double largest = limit, smallest = limit;
    for (const int i : usable) {
      const double s = standardised(problem, state, *done.covariance, i, used(i));
      if (used(i) && s > largest) worst = i, largest = s;
      if (!used(i) && s < smallest) best = i, smallest = s;
    }
    if (worst >= 0 && static_cast<int>(inliers.size()) > problem.pointsNeeded())
      inliers.erase(std::find(inliers.begin(), inliers.end(), worst));
    else if (worst < 0 && best >= 0)
      inliers.insert(std::upper_bound(inliers.begin(), inliers.end(), best), best);
    else
      break;
  }
  done.inliers = std::move(inliers);
  return done;
}

std::vector<ResectionResidual> residualsAt(const PoseProblem& problem, const PoseState& state) {
  std::vector<ResectionResidual> all;
  for (int i = 0; i < problem.size(); ++i) {
    ResectionResidual to;
    const ResectionObservation& o = problem.observations()[i];
    to.name = o.name;
    const auto at = problem.linearise(state, i);
    to.residualPx = at ? at->residualPx : glm::dvec2(noNumber);
    to.sigmas = problem.sigmas(state, i);
    to.outlier = !at;
    all.push_back(to);
  }
  return all;
}

void describeCorrelations(ResectionSummary& summary) {
  static constexpr const char* names[] = {"E", "N", "H", "the rotation about x", "the rotation about y", "the rotation about z"};
  constexpr double high = 0.95;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < r; ++c) {
      const double product = summary.covariance[r][r] * summary.covariance[c][c];
      if (!(product > 0)) continue;
      const double correlation = summary.covariance[r][c] / std::sqrt(product);
      if (std::abs(correlation) > high)
        summary.correlations.push_back(fmt::format("{} and {} can hardly be told apart (correlation {:.3f})", names[c],
                                                   names[r], correlation));
    }
}

ResectionSummary refused(ResectionSummary summary, std::string reason) {
  summary.converged = false;
  summary.reason = std::move(reason);
  return summary;
}

double redundancyOf(const PoseProblem& problem, const Adjusted& done) {
  return 2 * static_cast<double>(done.inliers.size()) - problem.freeCount();
}

/// A posteriori standard deviation of unit weight; 0 where nothing is redundant.
double sigma0Of(const PoseProblem& problem, const Adjusted& done) {
  const double redundancy = redundancyOf(problem, done);
  return redundancy > 0 ? std::sqrt(problem.cost(done.solution.state, done.inliers) / redundancy) : 0;
}

void describe(ResectionSummary& summary, const PoseProblem& problem, const PoseState& state, const Adjusted& done,
              const ResectionOptions& options) {
  summary.residuals = residualsAt(problem, state);
  double squares = 0;
  for (auto& r : summary.residuals) r.outlier = true;
  for (const int i : done.inliers) {
    ResectionResidual& r = summary.residuals[i];
    r.outlier = false;
    squares += glm::dot(r.residualPx, r.residualPx);
  }
  summary.rmsPx = std::sqrt(squares / static_cast<double>(done.inliers.size()));
  const Matrix6 covariance = summary.sigmaScale * summary.sigmaScale * *done.covariance;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) summary.covariance[r][c] = covariance(r, c);
  for (int i = 0; i < 3; ++i) {
    summary.positionStdM[i] = std::sqrt(covariance(i, i));
    summary.rotationStdRad[i] = std::sqrt(covariance(3 + i, 3 + i));
  }
  Covariance6 region = summary.covariance;
  const double wider = summary.sigmaScale > 1 ? widening95(redundancyOf(problem, done)) : 1;
  for (auto& row : region)
    for (double& value : row) value *= wider * wider;
  summary.ellipse = positionEllipse(region);
  describeCorrelations(summary);
  for (const glm::dvec3& at : options.at) summary.expected.push_back(expectedError(problem.camera(), problem.pose(state), region, at));
}

}  // namespace

Result<void> ResectionOptions::validate() const {
  if (const auto valid = checkRobustOptions(huberSigmas, outlierSigmas, maximumIterations); !valid) return valid;
  for (const glm::dvec3& p : at)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return fail("A point for the expected error is not finite", "at", "Give its coordinates in metres");
  return {};
}

Result<ResectionSummary> resect(const Camera& camera, const RigidTransform& startCameraFromWorld,
                                const std::vector<ResectionObservation>& observations,
                                const ResectionOptions& options) {
  if (const auto valid = options.validate(); !valid) return fail(valid.error().in("resection options"));
  PoseProblem problem(camera, startCameraFromWorld, observations, options);
  ResectionSummary summary;
  summary.cameraFromWorld = startCameraFromWorld;
  if (const auto why = refusalOfInput(problem, startCameraFromWorld)) return refused(summary, *why);
  std::vector<KnownPick> picks;
  for (const ResectionObservation& o : observations) picks.push_back({0, o.pixel, o.world, o.name});
  if (const auto twins = warningOfTwins(std::move(picks))) summary.warnings.push_back(*twins);
  const PoseState start = problem.startState();
  const auto refusedAtStart = [&](std::string reason) {
    summary.residuals = residualsAt(problem, start);
    return refused(std::move(summary), std::move(reason));
  };

  std::vector<int> all(problem.size()), usable;
  std::iota(all.begin(), all.end(), 0);
  for (const int i : all)
    if (std::isfinite(problem.sigmas(start, i))) usable.push_back(i);
  if (const auto why = refusalOfGeometry(problem, all)) return refusedAtStart(*why);
  if (const auto why = refusalOfSide(problem, usable)) return refusedAtStart(*why);
  if (const auto why = refusalOfGeometry(problem, usable)) return refusedAtStart(*why);
  if (!problem.covariance(problem.normalMatrix(start, usable)))
    return refusedAtStart(*refusalOfWeakness(problem, start, usable, 1));

  Consensus consensus = findConsensus(problem, usable, options);
  summary.iterations = consensus.iterations;
  const int agreeing = static_cast<int>(consensus.inliers.size());
  if (agreeing < problem.pointsNeeded() || 5 * agreeing < 2 * problem.size())
    return refusedAtStart(fmt::format("Only {} of {} observations agree with one pose; check the picks, the point "
                                      "numbers and the start pose", agreeing, problem.size()));
  if (const auto why = refusalOfTwoPoses(problem, consensus.state, consensus.inliers, consensus.scale))
    return refusedAtStart(*why);
  problem.weighAt(consensus.state);
  const double limit = std::max(options.outlierSigmas, chanceLimit(usable.size())) * consensus.scale;
  const Adjusted done = adjust(problem, consensus.state, consensus.inliers, usable, limit, options);
  summary.iterations += done.iterations;
  if (!done.solution.converged)
    return refusedAtStart(fmt::format("The solution did not settle within {} iterations; give a better start pose",
                                      options.maximumIterations));
  if (const auto why = refusalOfGeometry(problem, done.inliers)) return refusedAtStart(*why);
  const double sigma0 = sigma0Of(problem, done), sigmaScale = consensus.scale > 1 ? std::max(1.0, sigma0) : 1;
  if (const auto why = refusalOfWeakness(problem, done.solution.state, done.inliers, sigmaScale))
    return refusedAtStart(*why);

  summary.converged = true;
  summary.sigma0 = sigma0, summary.sigmaScale = sigmaScale;
  describe(summary, problem, done.solution.state, done, options);
  summary.cameraFromWorld = problem.pose(done.solution.state);
  summary.reason = reasonOfConvergence(consensus.scale > 1, summary.sigma0);
  return summary;
}

}  // namespace alidade
