// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/pose_problem.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace alidade {

namespace {

glm::dquat quaternionOf(const glm::dvec3& rotationVector) {
  const double angle = glm::length(rotationVector);
  // sin(angle/2)/angle, by its series near zero.
  const double share = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), share * rotationVector.x, share * rotationVector.y, share * rotationVector.z};
}

}  // namespace

PoseProblem::PoseProblem(const Camera& camera, const RigidTransform& start,
                         const std::vector<ResectionObservation>& observations, const ResectionOptions& options)
    : m_camera(camera), m_observations(observations), m_origin(start.centre()) {
  m_start.rotation = glm::normalize(start.rotation);
  for (int i = 0; i < 3; ++i)
    if (!options.lockPosition[i]) m_free.push_back(i);
  if (!options.lockAttitude) m_free.insert(m_free.end(), {3, 4, 5});
}

RigidTransform PoseProblem::pose(const PoseState& state) const {
  return {state.rotation, -(state.rotation * (m_origin + state.centre))};
}

glm::dvec3 PoseProblem::inCamera(const PoseState& state, const glm::dvec3& world) const {
  return state.rotation * ((world - m_origin) - state.centre);
}

bool PoseProblem::positionFree() const {
  return !m_free.empty() && m_free.front() < 3;
}

bool PoseProblem::attitudeFree() const {
  return !m_free.empty() && m_free.back() >= 3;
}

int PoseProblem::pointsNeeded() const {
  return allFree() ? 4 : (freeCount() + 1) / 2;
}

std::optional<Linearised> PoseProblem::lineariseAt(const PoseState& state, const glm::dvec3& world) const {
  const glm::dvec3 p = inCamera(state, world);
  if (!(p.z > 1e-9)) return std::nullopt;
  const double x = p.x / p.z, y = p.y / p.z;
  const DistortedPoint at = m_camera.domain().distortedWithJacobian(x, y);
  const Intrinsics& in = m_camera.intrinsics();
  const auto chained = [&](double focal, double byX, double byY) {
    return focal / p.z * glm::dvec3(byX, byY, -(byX * x + byY * y));
  };
  const glm::dvec3 rows[2] = {chained(in.fx, at.dx.x, at.dy.x), chained(in.fy, at.dx.y, at.dy.y)};
  const glm::dmat3 rotation = glm::mat3_cast(state.rotation);
  Linearised to;
  to.residualPx = {in.fx * at.position.x + in.cx, in.fy * at.position.y + in.cy};
  for (int i = 0; i < 2; ++i) {
    // row · (-R), and row · (w × p) = w · (p × row).
    const glm::dvec3 byCentre = -(rows[i] * rotation), byRotation = glm::cross(p, rows[i]);
    to.jacobian.row(i) << byCentre.x, byCentre.y, byCentre.z, byRotation.x, byRotation.y, byRotation.z;
  }
  return to;
}

std::optional<Linearised> PoseProblem::linearise(const PoseState& state, int observation) const {
  const ResectionObservation& seen = m_observations[observation];
  auto at = lineariseAt(state, seen.world);
  if (at) at->residualPx -= seen.pixel;
  return at;
}

double PoseProblem::sigmas(const PoseState& state, int observation) const {
  const ResectionObservation& seen = m_observations[observation];
  const glm::dvec3 p = inCamera(state, seen.world);
  if (!(p.z > 1e-9)) return std::numeric_limits<double>::infinity();
  const double distance = glm::length(m_camera.projectUnchecked(p) - seen.pixel) / seen.sigmaPx;
  return std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity();
}

double PoseProblem::cost(const PoseState& state, const std::vector<int>& chosen) const {
  double sum = 0;
  for (const int i : chosen) {
    const double s = sigmas(state, i);
    sum += s * s;
  }
  return sum;
}

Matrix6 PoseProblem::normalMatrix(const PoseState& state, const std::vector<int>& chosen) const {
  Matrix6 normal = Matrix6::Zero();
  for (const int i : chosen) {
    const auto at = linearise(state, i);
    if (!at) continue;
    const double weight = 1 / (m_observations[i].sigmaPx * m_observations[i].sigmaPx);
    normal += weight * at->jacobian.transpose() * at->jacobian;
  }
  Matrix6 masked = Matrix6::Zero();
  for (const int r : m_free)
    for (const int c : m_free) masked(r, c) = normal(r, c);
  return masked;
}

std::optional<Matrix6> PoseProblem::covariance(const Matrix6& normal) const {
  const int n = freeCount();
  // Scaled to a unit diagonal first: metres and radians differ by orders of magnitude.
  Eigen::VectorXd scale(n);
  Eigen::MatrixXd scaled(n, n);
  for (int i = 0; i < n; ++i) {
    const double diagonal = normal(m_free[i], m_free[i]);
    if (!(diagonal > 0) || !std::isfinite(diagonal)) return std::nullopt;
    scale[i] = 1 / std::sqrt(diagonal);
  }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) scaled(i, j) = normal(m_free[i], m_free[j]) * scale[i] * scale[j];
  const Eigen::LDLT<Eigen::MatrixXd> factor(scaled);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-13)) return std::nullopt;
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
  Matrix6 covariance = Matrix6::Zero();
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      covariance(m_free[i], m_free[j]) = 0.5 * (inverse(i, j) + inverse(j, i)) * scale[i] * scale[j];
  return covariance;
}

Vector6 PoseProblem::gradient(const PoseState& state, const std::vector<int>& chosen) const {
  Vector6 sum = Vector6::Zero(), masked = Vector6::Zero();
  for (const int i : chosen) {
    const auto at = linearise(state, i);
    if (!at) continue;
    const double weight = 1 / (m_observations[i].sigmaPx * m_observations[i].sigmaPx);
    sum += weight * at->jacobian.transpose() * Eigen::Vector2d(at->residualPx.x, at->residualPx.y);
  }
  for (const int r : m_free) masked[r] = sum[r];
  return masked;
}

double PoseProblem::decrement(const PoseState& state, const std::vector<int>& chosen) const {
  const auto inverse = covariance(normalMatrix(state, chosen));
  if (!inverse) return std::numeric_limits<double>::infinity();
  const Vector6 g = gradient(state, chosen);
  return std::sqrt(std::max(0.0, g.dot(*inverse * g)));
}

PoseState PoseProblem::moved(const PoseState& state, const Vector6& step) const {
  PoseState to;
  to.centre = state.centre + glm::dvec3(step[0], step[1], step[2]);
  to.rotation = glm::normalize(quaternionOf({step[3], step[4], step[5]}) * state.rotation);
  return to;
}

PoseState PoseProblem::descend(PoseState state, const std::vector<int>& chosen, int iterations) const {
  double damping = 1e-6, error = cost(state, chosen);
  for (int i = 0; i < iterations && std::isfinite(error); ++i) {
    const Matrix6 normal = normalMatrix(state, chosen);
    const Vector6 slope = gradient(state, chosen);
    Matrix6 damped = Matrix6::Identity();
    Vector6 right = Vector6::Zero();
    for (const int r : m_free) {
      right[r] = -slope[r];
      for (const int c : m_free) damped(r, c) = normal(r, c);
      damped(r, r) = normal(r, r) * (1 + damping) + 1e-30;
    }
    const Vector6 step = damped.ldlt().solve(right);
    if (!step.allFinite()) break;
    const PoseState next = moved(state, step);
    const double nextError = cost(next, chosen);
    if (nextError < error) {
      const bool done = error - nextError < 1e-12 * error;
      state = next, error = nextError;
      damping = std::max(1e-12, damping * 0.1);
      if (done) break;
    } else {
      damping = std::max(1e-6, damping * 10);
      if (damping > 1e8) break;
    }
  }
  return state;
}

}  // namespace alidade
