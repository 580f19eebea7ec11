// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/pose_accuracy.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace alidade {

namespace {

constexpr double chiSquared95 = 5.991464547107979;  // two degrees of freedom

}  // namespace

ExpectedError expectedError(const Camera& camera, const RigidTransform& cameraFromWorld, const Covariance6& covariance, const glm::dvec3& world) {
  ExpectedError expected;
  expected.world = world;
  const glm::dvec3 p = cameraFromWorld * world;
  ProjectionJacobian by;
  if (!camera.project(p, by)) {
    expected.ellipseSemiMajorPx = expected.ellipseSemiMinorPx = expected.ellipseAngleRad = expected.millimetres = std::nan("");
    return expected;
  }
  // dp = -R dC + w × p.
  const glm::dmat3 rotation = cameraFromWorld.rotationMatrix();
  Eigen::Matrix<double, 3, 6> moves;
  Eigen::Matrix<double, 6, 6> ofPose;
  for (int k = 0; k < 6; ++k) {
    glm::dvec3 unit(0);
    unit[k % 3] = 1;
    const glm::dvec3 move = k < 3 ? -(rotation * unit) : glm::cross(unit, p);
    moves.col(k) << move.x, move.y, move.z;
    for (int r = 0; r < 6; ++r) ofPose(r, k) = covariance[r][k];
  }
  const Eigen::Matrix3d ofPoint = moves * ofPose * moves.transpose();
  Eigen::Matrix<double, 2, 3> projection;
  projection << by.du.x, by.du.y, by.du.z, by.dv.x, by.dv.y, by.dv.z;
  const Eigen::Matrix2d pixel = projection * ofPoint * projection.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(pixel);
  expected.ellipseSemiMinorPx = std::sqrt(chiSquared95 * std::max(0.0, axes.eigenvalues()[0]));
  expected.ellipseSemiMajorPx = std::sqrt(chiSquared95 * std::max(0.0, axes.eigenvalues()[1]));
  const Eigen::Vector2d major = axes.eigenvectors().col(1);
  expected.ellipseAngleRad = std::atan2(major[1], major[0]);
  const glm::dvec3 ray = glm::normalize(p);
  const Eigen::Vector3d d(ray.x, ray.y, ray.z);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
  const double largest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(across * ofPoint * across).eigenvalues()[2];
  expected.millimetres = 1000 * std::sqrt(chiSquared95 * std::max(0.0, largest));
  return expected;
}

PositionEllipse positionEllipse(const Covariance6& covariance) {
  Eigen::Matrix2d horizontal;
  horizontal << covariance[0][0], covariance[0][1], covariance[1][0], covariance[1][1];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(horizontal);
  PositionEllipse ellipse;
  ellipse.semiMinorM = std::sqrt(chiSquared95 * std::max(0.0, axes.eigenvalues()[0]));
  ellipse.semiMajorM = std::sqrt(chiSquared95 * std::max(0.0, axes.eigenvalues()[1]));
  const Eigen::Vector2d major = axes.eigenvectors().col(1);
  ellipse.azimuthRad = std::atan2(major[0], major[1]);
  if (ellipse.azimuthRad < 0) ellipse.azimuthRad += M_PI;
  ellipse.heightM = 1.959963984540054 * std::sqrt(std::max(0.0, covariance[2][2]));
  return ellipse;
}

}  // namespace alidade
