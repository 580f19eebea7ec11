// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/resection_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

namespace alidade {

namespace {

bool isFinite(const glm::dvec2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

bool isFinite(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

std::string nameOf(const PoseProblem& problem, int i) {
  const std::string& name = problem.observations()[i].name;
  return name.empty() ? fmt::format("observation {}", i + 1) : fmt::format("observation \"{}\"", name);
}

/// Points closer than a micrometre, or than what a double holds at their coordinates, are one. Counts to `enough`.
int distinctPoints(const PoseProblem& problem, const std::vector<int>& chosen, int enough) {
  std::vector<glm::dvec3> kept;
  for (const int i : chosen) {
    if (static_cast<int>(kept.size()) >= enough) break;
    const glm::dvec3 p = problem.observations()[i].world;
    const double same = 1e-6 + 4e-16 * glm::length(p);
    if (std::none_of(kept.begin(), kept.end(), [&](const glm::dvec3& k) { return glm::length(k - p) < same; }))
      kept.push_back(p);
  }
  return static_cast<int>(kept.size());
}

/// Principal axes of the points: standard deviations, smallest first, and directions.
struct Spread {
  glm::dvec3 centre{0};
  glm::dvec3 deviation{0};
  glm::dvec3 leastAxis{0};
};

Spread spreadOf(const PoseProblem& problem, const std::vector<int>& chosen) {
  Spread spread;
  const double n = static_cast<double>(chosen.size());
  for (const int i : chosen) spread.centre += (problem.observations()[i].world - problem.origin()) / n;
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (const int i : chosen) {
    const glm::dvec3 d = problem.observations()[i].world - problem.origin() - spread.centre;
    const Eigen::Vector3d e(d.x, d.y, d.z);
    moment += e * e.transpose() / n;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moment);
  for (int i = 0; i < 3; ++i) spread.deviation[i] = std::sqrt(std::max(0.0, axes.eigenvalues()[i]));
  const Eigen::Vector3d least = axes.eigenvectors().col(0);
  spread.leastAxis = {least[0], least[1], least[2]};
  return spread;
}

double medianDistance(const PoseProblem& problem, const PoseState& state, const std::vector<int>& chosen) {
  std::vector<double> distances;
  for (const int i : chosen) distances.push_back(glm::length(problem.inCamera(state, problem.observations()[i].world)));
  std::nth_element(distances.begin(), distances.begin() + distances.size() / 2, distances.end());
  return distances[distances.size() / 2];
}

double largestDeviation(const Matrix6& covariance, int first) {
  const Eigen::Matrix3d block = covariance.block<3, 3>(first, first);
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block).eigenvalues()[2]));
}

}  // namespace

std::optional<std::string> refusalOfInput(const PoseProblem& problem, const RigidTransform& start) {
  const Intrinsics& in = problem.camera().intrinsics();
  if (!in.validate()) return "The camera's calibration cannot be used; load it again";
  if (!start.isFinite()) return "The start pose is not a finite pose; give an approximate position and attitude";
  if (problem.freeCount() == 0) return "Position and attitude are both locked, nothing is left to refine; free one of them";
  for (int i = 0; i < problem.size(); ++i) {
    const ResectionObservation& o = problem.observations()[i];
    if (!isFinite(o.pixel) || !isFinite(o.world))
      return fmt::format("{} holds a coordinate that is not a finite number; correct or delete it", nameOf(problem, i));
    if (!(o.sigmaPx > 0) || !std::isfinite(o.sigmaPx))
      return fmt::format("{} has the standard deviation {} px; it must be positive", nameOf(problem, i), o.sigmaPx);
    if (!(o.sigmaM >= 0) || !std::isfinite(o.sigmaM))
      return fmt::format("The point of {} has the standard deviation {} m; it must be zero or positive", nameOf(problem, i), o.sigmaM);
  }
  return std::nullopt;
}

std::optional<std::string> refusalOfGeometry(const PoseProblem& problem, const std::vector<int>& chosen) {
  const int needed = problem.pointsNeeded();
  if (static_cast<int>(chosen.size()) < needed)
    return fmt::format("{} observations for {} free parameters, at least {} are needed{}; pick more points",
                       chosen.size(), problem.freeCount(), needed, problem.allFree() ? " (three leave up to four poses, the fourth decides)" : "");
  const int distinct = distinctPoints(problem, chosen, needed);
  if (distinct < needed)
    return fmt::format("The {} observations are of {} different points only, at least {} are needed; the others are "
                       "duplicates: pick other points", chosen.size(), distinct, needed);
  if (problem.freeCount() < 3) return std::nullopt;

  glm::dvec2 low(INFINITY), high(-INFINITY);
  double sigma = 0;
  for (const int i : chosen) {
    const ResectionObservation& o = problem.observations()[i];
    low = glm::min(low, o.pixel), high = glm::max(high, o.pixel);
    sigma = std::max(sigma, o.sigmaPx);
  }
  if (glm::length(high - low) < std::max(1.0, 6 * sigma))
    return fmt::format("All pixels lie in one spot, within {:.1f} px; pick points all over the picture",
                       glm::length(high - low));
  const Spread spread = spreadOf(problem, chosen);
  if (problem.allFree() && spread.deviation[1] < 1e-4 * spread.deviation[2])
    return "All world points are collinear: the camera could turn about their line; pick points beside the line";
  return std::nullopt;
}

std::optional<std::string> refusalOfSide(const PoseProblem& problem, const std::vector<int>& usable) {
  const int n = problem.size(), behind = n - static_cast<int>(usable.size());
  if (behind == 0 || (2 * behind <= n && static_cast<int>(usable.size()) >= problem.pointsNeeded())) return std::nullopt;
  return fmt::format("{} of {} points lie behind the camera at the start pose; correct the start pose or the points",
                     behind, n);
}

std::optional<std::string> warningOfTwins(std::vector<KnownPick> picks) {
  const auto key = [](const KnownPick& p) { return std::tuple(p.frame, p.pixel.x, p.pixel.y, p.world.x, p.world.y, p.world.z); };
  std::stable_sort(picks.begin(), picks.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  int twins = 0;
  const KnownPick* first = nullptr;
  for (std::size_t i = 1; i < picks.size(); ++i)
    if (key(picks[i]) == key(picks[i - 1]) && twins++ == 0) first = &picks[i];
  if (twins == 0) return std::nullopt;
  return fmt::format("{} the pixel and the point of another and {} twice (\"{}\" and \"{}\" first); delete one of the two",
                     twins == 1 ? "1 observation has" : fmt::format("{} observations have", twins),
                     twins == 1 ? "counts" : "count", (first - 1)->name, first->name);
}

double weakestPositionM(double distanceM) {
  // From far away, a twentieth of the distance is no position any more.
  return std::min(0.05 * distanceM, 1.0);
}

std::optional<std::string> refusalOfWeakness(const PoseProblem& problem, const PoseState& state,
                                             const std::vector<int>& chosen, double sigmaScale) {
  const auto covariance = problem.covariance(problem.normalMatrix(state, chosen));
  if (!covariance)
    return "The observations leave a free parameter undetermined (singular normal equations); pick points spread over "
           "the picture and in depth, or lock what is known";
  const double distance = medianDistance(problem, state, chosen);
  const double position = sigmaScale * largestDeviation(*covariance, 0);
  const double rotation = sigmaScale * largestDeviation(*covariance, 3);
  constexpr double weakest = 0.05;
  if (position > weakestPositionM(distance))
    return fmt::format("The position is undetermined: its standard deviation would be {:.3g} m with the points {:.3g} m "
                       "away; pick points that are nearer, spread over the picture and in depth, or lock the position",
                       position, distance);
  if (rotation > weakest)
    return fmt::format("The attitude is undetermined: its standard deviation would be {:.2g} rad; pick points spread "
                       "over the picture, or lock the attitude", rotation);
  return std::nullopt;
}

std::optional<std::string> refusalOfTwoPoses(const PoseProblem& problem, PoseState& state,
                                             const std::vector<int>& chosen, double sigmaScale) {
  const Spread spread = spreadOf(problem, chosen);
  // Off the plane by less than a twentieth of their extent, the mirrored pose may still fit.
  if (!problem.allFree() || spread.deviation[0] > 0.05 * spread.deviation[2]) return std::nullopt;

  // Mirrored at the plane through the centroid across the line of sight, a flat set of points is
  // again a rotation of itself: (I - 2 d dᵀ)(I - 2 n nᵀ), d the line of sight, n the normal.
  const glm::dvec3 centroid = state.rotation * (spread.centre - state.centre);
  const glm::dvec3 d = glm::normalize(centroid), n = state.rotation * spread.leastAxis;
  const auto mirror = [](const glm::dvec3& axis) { return glm::dmat3(1) - 2.0 * glm::outerProduct(axis, axis); };
  PoseState other;
  other.rotation = glm::normalize(glm::quat_cast(mirror(d) * mirror(n) * glm::mat3_cast(state.rotation)));
  other.centre = spread.centre - glm::conjugate(other.rotation) * centroid;
  other = problem.descend(other, chosen, 200);

  const double angle = rotationAngleBetween(problem.pose(state), problem.pose(other));
  const double unit = sigmaScale * sigmaScale;
  const double mine = problem.cost(state, chosen) / unit, its = problem.cost(other, chosen) / unit;
  const auto covariance = problem.covariance(problem.normalMatrix(state, chosen));
  const double deviation = covariance ? sigmaScale * largestDeviation(*covariance, 3) : 0;
  if (!std::isfinite(its) || angle < std::max(1e-4, 5 * deviation)) return std::nullopt;
  // Likelihood ratio of one to a hundred.
  constexpr double clear = 9.21;
  if (its > mine + clear) return std::nullopt;
  if (its < mine - clear) {
    state = other;
    return std::nullopt;
  }
  return fmt::format("The points lie in one plane and fit a second pose as well, turned by {:.1f} degrees; pick a point "
                     "off the plane", angle * 180 / 3.14159265358979323846);
}

}  // namespace alidade
