// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/pose_problem.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace alidade {

PoseProblem::PoseProblem(const Camera& camera, const RigidTransform& start,
                         const std::vector<ResectionObservation>& observations, const ResectionOptions& options)
    : m_camera(camera), m_observations(observations), m_origin(start.centre()) {
  m_start.rotation = glm::normalize(start.rotation);
  for (int i = 0; i < 3; ++i)
    if (!options.lockPosition[i]) m_free.push_back(i);
  if (!options.lockAttitude) m_free.insert(m_free.end(), {3, 4, 5});
  if (options.shutter.isOn())
    for (const ResectionObservation& seen : observations) {
      const RigidTransform row = exponential(options.shutter.motion * options.shutter.secsAtRow(seen.pixel.y, camera.height()));
      m_rows.push_back({row.rotationMatrix(), row.translation});
    }
  weighAt(m_start);
}

void PoseProblem::weighAt(const PoseState& state) {
  m_weights.resize(m_observations.size());
  for (int i = 0; i < size(); ++i) {
    const ResectionObservation& seen = m_observations[i];
    glm::dmat2 covariance(seen.sigmaPx * seen.sigmaPx);
    if (seen.sigmaM > 0) {
      const glm::dvec3 p = inCamera(state, i);
      ProjectionJacobian by;
      if (p.z > 0 && m_camera.project(p, by)) {
        // An isotropic point: no rotation in J J^T.
        const double variance = seen.sigmaM * seen.sigmaM, mixed = variance * glm::dot(by.du, by.dv);
        covariance += glm::dmat2(variance * glm::dot(by.du, by.du), mixed, mixed, variance * glm::dot(by.dv, by.dv));
      }
    }
    m_weights[i] = glm::inverse(covariance);
  }
}

RigidTransform PoseProblem::pose(const PoseState& state) const {
  return {state.rotation, -(state.rotation * (m_origin + state.centre))};
}

glm::dvec3 PoseProblem::inCamera(const PoseState& state, const glm::dvec3& world) const {
  return state.rotation * ((world - m_origin) - state.centre);
}

glm::dvec3 PoseProblem::inCamera(const PoseState& state, int observation) const {
  const glm::dvec3 p = inCamera(state, m_observations[observation].world);
  return m_rows.empty() ? p : m_rows[observation].rotation * p + m_rows[observation].translation;
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

std::optional<Linearised> PoseProblem::lineariseAt(const PoseState& state, const glm::dvec3& world, const RowPose* row) const {
  const glm::dmat3 rotation = glm::mat3_cast(state.rotation);
  const glm::dvec3 middle = rotation * ((world - m_origin) - state.centre);
  const glm::dvec3 p = row ? row->rotation * middle + row->translation : middle;
  if (!(p.z > 1e-9)) return std::nullopt;
  const double x = p.x / p.z, y = p.y / p.z;
  const DistortedPoint at = m_camera.domain().distortedWithJacobian(x, y);
  const Intrinsics& in = m_camera.intrinsics();
  const auto chained = [&](double focal, double byX, double byY) {
    return focal / p.z * glm::dvec3(byX, byY, -(byX * x + byY * y));
  };
  glm::dvec3 rows[2] = {chained(in.fx, at.dx.x, at.dy.x), chained(in.fy, at.dx.y, at.dy.y)};
  if (row) rows[0] = rows[0] * row->rotation, rows[1] = rows[1] * row->rotation;
  Linearised to;
  to.residualPx = {in.fx * at.position.x + in.cx, in.fy * at.position.y + in.cy};
  for (int i = 0; i < 2; ++i) {
    // row · (-R), and row · (w × p) = w · (p × row), p at the middle row.
    const glm::dvec3 byCentre = -(rows[i] * rotation), byRotation = glm::cross(middle, rows[i]);
    to.jacobian.row(i) << byCentre.x, byCentre.y, byCentre.z, byRotation.x, byRotation.y, byRotation.z;
  }
  return to;
}

std::optional<Linearised> PoseProblem::linearise(const PoseState& state, int observation) const {
  const ResectionObservation& seen = m_observations[observation];
  auto at = lineariseAt(state, seen.world, m_rows.empty() ? nullptr : &m_rows[observation]);
  if (at) at->residualPx -= seen.pixel;
  return at;
}

double PoseProblem::sigmas(const PoseState& state, int observation) const {
  const ResectionObservation& seen = m_observations[observation];
  const glm::dvec3 p = inCamera(state, observation);
  if (!(p.z > 1e-9)) return std::numeric_limits<double>::infinity();
  const glm::dvec2 r = m_camera.projectUnchecked(p) - seen.pixel;
  const double distance = std::sqrt(glm::dot(r, m_weights[observation] * r));
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

PoseProblem::Normals PoseProblem::normals(const PoseState& state, const std::vector<int>& chosen, double huberSigmas,
                                          bool skipBehind) const {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  Normals sum;
  for (const int i : chosen) {
    const auto at = linearise(state, i);
    if (!at) {
      if (skipBehind) continue;
      sum.cost = std::numeric_limits<double>::infinity();
      return sum;
    }
    const glm::dmat2& p = m_weights[i];
    const glm::dvec2 weighted = p * at->residualPx;
    const double squares = glm::dot(at->residualPx, weighted), s = std::sqrt(squares);
    const bool far = huberSigmas > 0 && s > huberSigmas;
    const double share = far ? huberSigmas / s : 1;
    sum.cost += far ? huberSigmas * (2 * s - huberSigmas) : squares;
    // Upper triangle of Jᵀ P J and Jᵀ P r, entry by entry: this loop is most of a resection's time.
    double weightedU[6], weightedV[6];
    for (int c = 0; c < 6; ++c) {
      const double u = share * at->jacobian(0, c), v = share * at->jacobian(1, c);
      weightedU[c] = p[0][0] * u + p[1][0] * v;
      weightedV[c] = p[0][1] * u + p[1][1] * v;
      gradient[c] += weightedU[c] * at->residualPx.x + weightedV[c] * at->residualPx.y;
    }
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r <= c; ++r) matrix(r, c) += weightedU[r] * at->jacobian(0, c) + weightedV[r] * at->jacobian(1, c);
  }
  matrix.triangularView<Eigen::StrictlyLower>() = matrix.transpose();
  if (!std::isfinite(sum.cost)) sum.cost = std::numeric_limits<double>::infinity();
  for (const int r : m_free) {
    sum.gradient[r] = gradient[r];
    for (const int c : m_free) sum.matrix(r, c) = matrix(r, c);
  }
  return sum;
}

Matrix6 PoseProblem::normalMatrix(const PoseState& state, const std::vector<int>& chosen) const {
  return normals(state, chosen, 0, true).matrix;
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

double PoseProblem::decrement(const PoseState& state, const std::vector<int>& chosen) const {
  const Normals at = normals(state, chosen, 0, true);
  const auto inverse = covariance(at.matrix);
  if (!inverse) return std::numeric_limits<double>::infinity();
  return std::sqrt(std::max(0.0, at.gradient.dot(*inverse * at.gradient)));
}

PoseState PoseProblem::descend(PoseState state, const std::vector<int>& chosen, int iterations, double huberSigmas,
                               int* used) const {
  double damping = 1e-6;
  // A robust solution only starts what least squares finishes.
  const double enough = huberSigmas > 0 ? 1e-3 : 1e-14;
  Normals at = normals(state, chosen, huberSigmas, false);
  for (int i = 0; i < iterations && std::isfinite(at.cost); ++i) {
    if (used) ++*used;
    Matrix6 damped = Matrix6::Identity();
    for (const int r : m_free) {
      for (const int c : m_free) damped(r, c) = at.matrix(r, c);
      damped(r, r) = at.matrix(r, r) * (1 + damping) + 1e-30;
    }
    const Vector6 step = damped.ldlt().solve(-at.gradient);
    if (!step.allFinite()) break;
    const PoseState next = moved(state, step.data());
    const Normals there = normals(next, chosen, huberSigmas, false);
    if (there.cost < at.cost) {
      const bool done = at.cost - there.cost < enough * at.cost;
      state = next, at = there;
      damping = std::max(1e-12, damping * 0.1);
      if (done) break;
    } else {
      // A step too short to change the cost's last digits is still the better state.
      if (-at.gradient.dot(step) < 1e-13 * at.cost) {
        if (std::isfinite(there.cost)) state = next;
        break;
      }
      damping = std::max(1e-6, damping * 10);
      if (damping > 1e8) break;
    }
  }
  return state;
}

}  // namespace alidade
