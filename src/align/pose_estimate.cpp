// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "align/pose_estimate.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace alidade {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int kIterations = 12;
constexpr double kCauchy = 2.4;    // standard deviations: 95 % efficient on normal residuals
constexpr double kMatchNoisePx = 0.1;
/// A squared normal residual of two dimensions exceeds this in half the cases: 2 ln 2.
constexpr double kMedianOfTwo = 1.3862943611198906;

struct Row {
  glm::dvec2 residual{0};
  Eigen::Matrix<double, 2, 6> jacobian;
  Eigen::Matrix2d information;
  double squares = 0;  ///< in standard deviations
  bool inView = false;
};

struct Normals {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  Normals& operator+=(const Normals& other) {
    matrix += other.matrix, gradient += other.gradient;
    return *this;
  }
  Normals operator-(const Normals& other) const { return {matrix - other.matrix, gradient - other.gradient}; }
};

/// What matching itself adds to every place: (W⁻¹ + s² I)⁻¹ without inverting a singular W.
Eigen::Matrix2d softened(const glm::dmat2& information) {
  Eigen::Matrix2d w;
  w << information[0][0], information[1][0], information[0][1], information[1][1];
  return w * (Eigen::Matrix2d::Identity() + kMatchNoisePx * kMatchNoisePx * w).inverse();
}

RigidTransform moved(const RigidTransform& pose, const Vector6& step) {
  const glm::dvec3 turn(step[3], step[4], step[5]);
  const double angle = glm::length(turn);
  const glm::dquat by = angle > 0 ? glm::angleAxis(angle, turn / angle) : glm::dquat(1, 0, 0, 0);
  RigidTransform to;
  to.rotation = glm::normalize(by * pose.rotation);
  to.translation = -(to.rotation * (pose.centre() + glm::dvec3(step[0], step[1], step[2])));
  return to;
}

std::vector<Row> linearise(const Camera& camera, const RigidTransform& pose, const std::vector<SeenPlace>& places) {
  const glm::dmat3 rotation = pose.rotationMatrix();
  std::vector<Row> rows(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    Row& row = rows[i];
    const glm::dvec3 p = pose * places[i].world;
    ProjectionJacobian by;
    const auto pixel = p.z > 0.05 ? camera.project(p, by) : std::nullopt;
    if (!pixel) continue;
    row.inView = true;
    row.residual = *pixel - places[i].pixel;
    row.information = softened(places[i].information);
    const glm::dvec3 duR = by.du * rotation, dvR = by.dv * rotation;  // rows times R
    const glm::dvec3 duW = glm::cross(p, by.du), dvW = glm::cross(p, by.dv);  // -[p]x from the left
    row.jacobian << -duR.x, -duR.y, -duR.z, duW.x, duW.y, duW.z, -dvR.x, -dvR.y, -dvR.z, dvW.x, dvW.y, dvW.z;
    const Eigen::Vector2d r(row.residual.x, row.residual.y);
    row.squares = r.dot(row.information * r);
  }
  return rows;
}

double robustScale(const std::vector<Row>& rows) {
  std::vector<double> squares;
  for (const Row& row : rows)
    if (row.inView) squares.push_back(row.squares);
  if (squares.empty()) return 1;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2), squares.end());
  return std::max(1.0, std::sqrt(squares[squares.size() / 2] / kMedianOfTwo));
}

double weightOf(const Row& row, double scale) {
  return row.inView ? 1 / (1 + row.squares / (scale * scale * kCauchy * kCauchy)) : 0;
}

std::map<int, Normals> normalsOf(const std::vector<Row>& rows, const std::vector<SeenPlace>& places, double scale) {
  std::map<int, Normals> blocks;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double weight = weightOf(row, scale);
    if (weight <= 0) continue;
    Normals& to = blocks[places[i].block];
    to.matrix += weight * row.jacobian.transpose() * row.information * row.jacobian;
    to.gradient -= weight * row.jacobian.transpose() * row.information * Eigen::Vector2d(row.residual.x, row.residual.y);
  }
  return blocks;
}

/// What was known beforehand, as normal equations at this pose.
Normals knowledgeOf(const PoseKnowledge& known, const RigidTransform& pose) {
  Normals normals;
  const glm::dvec3 centre = known.cameraFromWorld.centre() - pose.centre();
  glm::dquat turn = known.cameraFromWorld.rotation * glm::conjugate(pose.rotation);
  if (turn.w < 0) turn = -turn;
  for (int i = 0; i < 3; ++i) {
    const double position = known.positionSigmaM > 0 ? 1 / (known.positionSigmaM * known.positionSigmaM) : 0;
    const double rotation = known.rotationSigmaRad > 0 ? 1 / (known.rotationSigmaRad * known.rotationSigmaRad) : 0;
    normals.matrix(i, i) = position, normals.gradient[i] = position * centre[i];
    normals.matrix(3 + i, 3 + i) = rotation, normals.gradient[3 + i] = rotation * 2 * (i == 0 ? turn.x : i == 1 ? turn.y : turn.z);
  }
  return normals;
}

/// Inverse over the free parameters, zero elsewhere; nothing where something free is open.
std::optional<Matrix6> inverse(const Matrix6& normal, const std::array<bool, 6>& locked) {
  Matrix6 scaled = Matrix6::Zero();
  Vector6 scale = Vector6::Zero();
  for (int i = 0; i < 6; ++i) {
    if (!locked[i] && !(normal(i, i) > 0)) return std::nullopt;
    scale[i] = locked[i] ? 0 : 1 / std::sqrt(normal(i, i));
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) scaled(i, j) = i == j ? 1 : scale[i] * normal(i, j) * scale[j];
  const Eigen::LDLT<Matrix6> factor(scaled);
  if (factor.info() != Eigen::Success || factor.vectorD().minCoeff() < 1e-9) return std::nullopt;
  return Matrix6(scale.asDiagonal() * factor.solve(Matrix6::Identity()) * scale.asDiagonal());
}

}  // namespace

int PoseEstimate::counting() const {
  return static_cast<int>(std::count_if(weights.begin(), weights.end(), [](double w) { return w >= 0.5; }));
}

RigidTransform withLocked(const RigidTransform& cameraFromWorld, const PoseKnowledge& known) {
  glm::dvec3 centre = cameraFromWorld.centre();
  const glm::dvec3 knownCentre = known.cameraFromWorld.centre();
  for (int i = 0; i < 3; ++i)
    if (known.locked[i]) centre[i] = knownCentre[i];
  RigidTransform held;
  held.rotation = known.locked[3] && known.locked[4] && known.locked[5] ? known.cameraFromWorld.rotation : cameraFromWorld.rotation;
  held.translation = -(held.rotation * centre);
  return held;
}

std::optional<PoseEstimate> estimatePose(const Camera& camera, const RigidTransform& start, const std::vector<SeenPlace>& places,
                                         const PoseKnowledge& known) {
  PoseEstimate estimate;
  const std::array<bool, 6>& locked = known.locked;
  RigidTransform pose = start;
  std::vector<Row> rows = linearise(camera, pose, places);
  std::map<int, Normals> blocks;
  Matrix6 cofactors;
  Normals all;
  double scale = 1;
  for (int i = 0; i < kIterations; ++i) {
    scale = robustScale(rows);
    blocks = normalsOf(rows, places, scale);
    all = knowledgeOf(known, pose);
    for (const auto& [id, block] : blocks) all += block;
    const auto solved = inverse(all.matrix, locked);
    if (!solved || blocks.size() < 3) return std::nullopt;
    cofactors = *solved;
    const Vector6 step = cofactors * all.gradient;
    pose = moved(pose, step);
    rows = linearise(camera, pose, places);
    if (step.dot(all.matrix * step) < 1e-6) break;
  }
  scale = robustScale(rows);
  blocks = normalsOf(rows, places, scale);
  all = knowledgeOf(known, pose);
  for (const auto& [id, block] : blocks) all += block;

  // Each block's pull on the pose, were it left out.
  Matrix6 spread = Matrix6::Zero();
  for (const auto& [id, block] : blocks) {
    const Normals rest = all - block;
    const auto solved = inverse(rest.matrix, locked);
    if (!solved) return std::nullopt;
    const Vector6 pull = *solved * rest.gradient;
    spread += pull * pull.transpose();
  }
  const auto count = static_cast<double>(blocks.size());
  spread *= (count - 1) / count;
  const Matrix6 own = scale * scale * cofactors;
  // The larger of the two in the mean over the pixels, so that no direction is lost.
  double bySpread = 0, byOwn = 0, squares = 0, weights = 0;
  for (const Row& row : rows) {
    const double weight = weightOf(row, scale);
    estimate.weights.push_back(weight);
    if (!row.inView) continue;
    bySpread += (row.jacobian * spread * row.jacobian.transpose()).trace();
    byOwn += (row.jacobian * own * row.jacobian.transpose()).trace();
    if (weight < 0.5) continue;
    const Eigen::Vector2d r(row.residual.x, row.residual.y);
    squares += r.dot(row.information * r) / std::max(1e-12, 0.5 * row.information.trace()), ++weights;
  }
  const Matrix6 covariance = spread + own;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) estimate.covariance[i][j] = covariance(i, j);
  for (int i = 0; i < 3; ++i) {
    estimate.positionStdM[i] = std::sqrt(std::max(0.0, covariance(i, i)));
    estimate.rotationStdRad[i] = std::sqrt(std::max(0.0, covariance(3 + i, 3 + i)));
  }
  estimate.cameraFromWorld = pose;
  estimate.sigma0 = scale;
  estimate.rmsPx = weights > 0 ? std::sqrt(squares / weights) : 0;
  estimate.changePx = std::sqrt((bySpread + byOwn) / static_cast<double>(std::max<std::size_t>(1, rows.size())));
  return estimate;
}

}  // namespace alidade
