// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Poses against what is known of the way: priors, trajectories on their own clock, smoothness.

#include <algorithm>

#include "adjust/network_terms.h"

namespace alidade {

namespace {

Eigen::Matrix3d crossMatrix(const glm::dvec3& w) {
  Eigen::Matrix3d m;
  m << 0, -w.z, w.y, w.z, 0, -w.x, -w.y, w.x, 0;
  return m;
}

/// d log(exp(d) exp(w)) / dd at 0: the inverse left Jacobian of SO(3) (Solà et al., A micro Lie theory, 2018, eq. 146).
Eigen::Matrix3d logByLeft(const glm::dvec3& w) {
  const double angle = glm::length(w);
  const Eigen::Matrix3d m = crossMatrix(w);
  const double square = angle < 1e-3 ? 1.0 / 12 : 1 / (angle * angle) - (1 + std::cos(angle)) / (2 * angle * std::sin(angle));
  return Eigen::Matrix3d::Identity() - 0.5 * m + square * m * m;
}

Eigen::Matrix3d logByRight(const glm::dvec3& w) {
  return logByLeft(-w);
}

Eigen::Vector3d eigen(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

void write(const Matrix6& m, std::array<double, TermValue::mostRows * VaryingCamera::largestCount>& to) {
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) to[6 * r + c] = m(r, c);
}

}  // namespace

void NetworkTerms::poseDifference(const PoseState& state, const PoseState& known, const Matrix6& whitening,
                                  bool derivatives, TermValue& to) const {
  const glm::dvec3 turn = rotationVectorOf(state.rotation * glm::conjugate(known.rotation));
  Vector6 off;
  off << eigen(state.centre - known.centre), eigen(turn);
  const Vector6 whitened = whitening * off;
  to.rows = 6;
  std::copy_n(whitened.data(), 6, to.residual.begin());
  if (!derivatives) return;
  Matrix6 byPose = Matrix6::Zero();
  byPose.topLeftCorner<3, 3>().setIdentity();
  byPose.bottomRightCorner<3, 3>() = logByLeft(turn);
  write(whitening * byPose, to.byBlock[0]);
}

bool NetworkTerms::trajectory(const NetworkState& state, const Term& term, bool derivatives, TermValue& to) const {
  const TrajectoryUse& use = m_trajectoryUses[term.index];
  const NetworkTrajectory& way = m_network.trajectories[use.trajectory];
  const double time = m_network.poses[use.pose].timeSecs + state.clocks[use.trajectory];
  // The segment that holds the time; beyond either end the last one goes on straight, at most by its own length.
  const auto after = std::upper_bound(way.timeSecs.begin(), way.timeSecs.end(), time);
  const std::size_t last = way.timeSecs.size() - 1;
  const std::size_t i = std::clamp<std::size_t>(static_cast<std::size_t>(after - way.timeSecs.begin()), 1, last) - 1;
  const double span = way.timeSecs[i + 1] - way.timeSecs[i], share = (time - way.timeSecs[i]) / span;
  if (!(share > -1) || !(share < 2)) return false;
  const PoseState a = stateOf(way.bodyFromWorld[i], m_layout.origin), b = stateOf(way.bodyFromWorld[i + 1], m_layout.origin);
  const glm::dvec3 velocity = (b.centre - a.centre) / span;
  const glm::dvec3 spin = rotationVectorOf(b.rotation * glm::conjugate(a.rotation)) / span;
  const PoseState known{a.centre + share * span * velocity, glm::normalize(quaternionOf(share * span * spin) * a.rotation)};
  Matrix6 whitening = Matrix6::Zero();
  for (int k = 0; k < 6; ++k) whitening(k, k) = 1 / (k < 3 ? way.positionSigmaM : way.attitudeSigmaRad);
  const PoseState& pose = state.poses[use.pose];
  poseDifference(pose, known, whitening, derivatives, to);
  if (derivatives) {
    const glm::dvec3 turn = rotationVectorOf(pose.rotation * glm::conjugate(known.rotation));
    Vector6 byClock;
    byClock << -eigen(velocity), -logByRight(turn) * eigen(spin);
    byClock = whitening * byClock;
    std::copy_n(byClock.data(), 6, to.byBlock[1].begin());
  }
  return true;
}

void NetworkTerms::smooth(const NetworkState& state, const Term& term, bool derivatives, TermValue& to) const {
  const SmoothnessUse& use = m_smoothnessUses[term.index];
  const NetworkSmoothness& how = m_network.smoothness[use.smoothness];
  const PoseState &a = state.poses[use.a], &b = state.poses[use.b], &c = state.poses[use.c];
  const double t1 = m_network.poses[use.b].timeSecs - m_network.poses[use.a].timeSecs;
  const double t2 = m_network.poses[use.c].timeSecs - m_network.poses[use.b].timeSecs;
  const double root = std::sqrt(0.5 * (t1 + t2));
  const double linear = 1 / (how.metresPerSecond2 * root), angular = 1 / (how.radiansPerSecond2 * root);
  const glm::dvec3 first = rotationVectorOf(b.rotation * glm::conjugate(a.rotation));
  const glm::dvec3 second = rotationVectorOf(c.rotation * glm::conjugate(b.rotation));
  const glm::dvec3 bend = linear * ((c.centre - b.centre) / t2 - (b.centre - a.centre) / t1);
  const glm::dvec3 twist = angular * (second / t2 - first / t1);
  to.rows = 6;
  for (int i = 0; i < 3; ++i) to.residual[i] = bend[i], to.residual[3 + i] = twist[i];
  if (!derivatives) return;
  const auto block = [&](double byCentre, const Eigen::Matrix3d& byRotation, int index) {
    Matrix6 m = Matrix6::Zero();
    m.topLeftCorner<3, 3>() = linear * byCentre * Eigen::Matrix3d::Identity();
    m.bottomRightCorner<3, 3>() = angular * byRotation;
    write(m, to.byBlock[index]);
  };
  block(1 / t1, logByRight(first) / t1, 0);
  block(-1 / t2 - 1 / t1, -logByRight(second) / t2 - logByLeft(first) / t1, 1);
  block(1 / t2, logByLeft(second) / t2, 2);
}

}  // namespace alidade
