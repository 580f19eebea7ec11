// SPDX-FileCopyrightText: 2026 the Alidade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "adjust/pose_accuracy.h"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace alidade {

PositionEllipse positionEllipse(const Covariance6& covariance) {
  constexpr double chiSquared95 = 5.991464547107979;  // two degrees of freedom
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
